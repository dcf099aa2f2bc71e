//! Arguments of `identify`.

use std::path::PathBuf;

use clap::Args;
use libration_identify::{Hold, NoiseKind, ResponseKind, Start};

use super::number::time;
use super::{ClockName, TimeUnitName, timing};

/// Arguments of `identify`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct IdentifyArgs {
    /// Log with commands and responses
    #[arg(value_name = "LOG")]
    pub(crate) log: PathBuf,
    /// Signal of the command, e.g. a column or /topic.field
    #[arg(long, value_name = "SIGNAL")]
    pub(crate) command: String,
    /// Signal of the response
    #[arg(long, value_name = "SIGNAL")]
    pub(crate) response: String,
    /// Column of the time stamps [default: one with a name such as t, time, stamp; else the first]
    #[arg(long, value_name = "COLUMN")]
    pub(crate) time: Option<String>,
    /// Unit of the column of time [default: of the file or the name, else by the size of the numbers]
    #[arg(long, value_name = "UNIT")]
    pub(crate) time_unit: Option<TimeUnitName>,
    /// Clock of a log with several: that of the recorder, of the sender, or in the header of messages
    #[arg(long, value_name = "WHICH", default_value = "log")]
    pub(crate) clock: ClockName,
    /// Form of the response
    #[arg(long, value_name = "FORM", default_value = "auto", value_parser = forms)]
    pub(crate) model: Choice<ResponseKind>,
    /// Law of the noise
    #[arg(long, value_name = "LAW", default_value = "auto", value_parser = noises)]
    pub(crate) noise: Choice<NoiseKind>,
    /// Command between its time stamps (auto: zero; a line is reported, not chosen)
    #[arg(long, value_name = "HOLD", default_value = "auto", value_parser = holds)]
    pub(crate) hold: Choice<Hold>,
    /// File of a linear plant that the command drives through a lag, as --plant of `advise`
    #[arg(long, value_name = "FILE", conflicts_with = "model")]
    pub(crate) plant: Option<PathBuf>,
    /// Input of the plant [default: its only input]
    #[arg(long, value_name = "NAME", requires = "plant")]
    pub(crate) plant_input: Option<String>,
    /// Output of the plant [default: its only output]
    #[arg(long, value_name = "NAME", requires = "plant")]
    pub(crate) plant_output: Option<String>,
    /// Known dead time in s
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true, value_parser = time)]
    pub(crate) dead_time: Option<f64>,
    /// Known lag in s
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true, value_parser = time)]
    pub(crate) lag: Option<f64>,
    /// Known gain, in units of the response per unit of the command
    #[arg(long, value_name = "NUMBER", allow_hyphen_values = true, value_parser = finite)]
    pub(crate) gain: Option<f64>,
    /// Largest dead time to try, in s [default: an eighth of the log, up to 1 s or 50 responses]
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true, value_parser = time)]
    pub(crate) largest_dead_time: Option<f64>,
    /// What is assumed before the first response: rest, held (the first command acts, the loop moves), or unknown [default: rest if the
    /// log begins with a long hold, or has nearly all of a few changes of the command early]
    #[arg(long, value_name = "STATE", default_value = "auto", value_parser = starts)]
    pub(crate) start: Choice<Start>,
    /// Command before the log, if it was another than the first
    #[arg(long, value_name = "NUMBER", allow_hyphen_values = true, value_parser = finite)]
    pub(crate) command_before: Option<f64>,
    /// Most evaluations of the likelihood in the search of a model [default: 1000 to 20000, fewer for long logs]
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub(crate) budget: Option<usize>,
    /// Number of simulated logs that check the intervals (0: none)
    #[arg(long, value_name = "N", default_value_t = 100, allow_hyphen_values = true)]
    pub(crate) bootstrap: usize,
    /// Seed of the simulated logs
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(crate) seed: u64,
    /// Do not look for losses, jitter and two delays
    #[arg(long)]
    pub(crate) certain_arrivals: bool,
    /// Write the identified loop to FILE, as TOML for `advise --config`
    #[arg(long, value_name = "FILE")]
    pub(crate) save_loop: Option<PathBuf>,
    /// Write an HTML page to FILE
    #[arg(long, value_name = "FILE")]
    pub(crate) page: Option<PathBuf>,
    /// Print the result as JSON, with all digits
    #[arg(long)]
    pub(crate) json: bool,
}

const EXAMPLES: &str = "\
Examples:
  libration identify log.csv --command cmd --response q --page loop.html
  libration identify log.csv --command cmd --response q --model lag --gain 1 --save-loop loop.toml
  libration advise --config loop.toml

Forms: delay, lag, second-order, integrated-lag. Laws of noise: white, coloured, disturbance. Holds: zero, linear.
Exit codes: 0 the residuals do not contradict the model; 1 another verdict, or a failed run; 2 invalid input.";

fn finite(text: &str) -> Result<f64, String> {
    timing::finite(text).ok_or_else(|| "expected a finite number".to_owned())
}

/// One of several kinds, or all of them to choose from.
#[derive(Clone, Debug)]
pub(crate) struct Choice<T>(pub(crate) Vec<T>);

fn choice<T: Clone>(
    all: &[T],
    name: impl Fn(&T) -> &'static str,
    text: &str,
) -> Result<Choice<T>, String> {
    if text == "auto" {
        return Ok(Choice(all.to_vec()));
    }
    let found = all.iter().find(|kind| name(kind) == text);
    found.map(|kind| Choice(vec![kind.clone()])).ok_or_else(|| {
        let names: Vec<&str> = all.iter().map(&name).collect();
        format!("expected auto, {}", names.join(", "))
    })
}

fn forms(text: &str) -> Result<Choice<ResponseKind>, String> {
    choice(&ResponseKind::SIMPLE, ResponseKind::name, text)
}

fn noises(text: &str) -> Result<Choice<NoiseKind>, String> {
    choice(&NoiseKind::ALL, |kind| kind.name(), text)
}

fn starts(text: &str) -> Result<Choice<Start>, String> {
    choice(&Start::ALL, |start| start.name(), text)
}

fn holds(text: &str) -> Result<Choice<Hold>, String> {
    choice(&[Hold::Zero, Hold::Linear], |hold| hold.name(), text)
}
