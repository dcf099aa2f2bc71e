//! Arguments of `advise`.

use std::path::PathBuf;

use clap::Args;
use libration::control::{Feedback, Jitter, LqrWeights};
use libration_advise::{Measure, Request, Tolerance};
use libration_analyze::LatencyOption;

use super::number::{self, period_of_rate, time};
use super::timing::{feedback, finite, latency, law, weights};
use super::{LinearArgs, SystemArgs, TopicArgs};
use crate::error::Failure;

/// Arguments of `advise`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES, override_usage = USAGE, args_override_self = true)]
pub(crate) struct AdviseArgs {
    /// Request file; it also has keys without an option, e.g. for PID controllers and observers
    #[arg(long, value_name = "FILE", conflicts_with_all = REQUEST_OPTIONS)]
    pub(crate) config: Option<PathBuf>,
    #[command(flatten)]
    pub(super) system: Option<SystemArgs>,
    #[command(flatten)]
    pub(crate) linear: LinearArgs,
    /// Gains of the feedback −KP·q − KD·v of a system of `libration list`; a file of equations takes --gain [default: no loop; in s⁻² and s⁻¹, with --set m= in N/m and N·s/m]
    #[arg(long, value_name = "KP,KD", value_parser = feedback, allow_hyphen_values = true)]
    pub(super) feedback: Option<Feedback>,
    /// Sample period of the loop in s, also as 2ms or 500Hz [default: 0.01, or that of a sampled plant]
    #[arg(long, value_name = "SECONDS", value_parser = number::period, allow_hyphen_values = true)]
    period: Option<f64>,
    /// Rate of the loop in Hz in place of its period, e.g. 500 or 0.5kHz
    #[arg(long = "rate", value_name = "HZ", value_parser = period_of_rate, conflicts_with = "period", allow_hyphen_values = true)]
    period_of_rate: Option<f64>,
    /// Latency of a command: 0.015 (in s), 15ms, 1.5steps (of --period) or preset:NAME; with --plant also one for each input, e.g. 0.003,0.01
    /// [default: 0]
    #[arg(
        long,
        value_name = "TIME",
        value_parser = latency,
        value_delimiter = ',',
        allow_hyphen_values = true
    )]
    pub(super) latency: Vec<LatencyOption>,
    /// Jitter of the period: gaussian or uniform, and its rms relative to the period (0 to 1), e.g. gaussian:0.05
    #[arg(
        long,
        value_name = "LAW:RMS",
        value_parser = law,
        allow_hyphen_values = true
    )]
    pub(super) jitter: Option<Jitter>,
    /// File of measured time stamps instead of --jitter: from `measure-jitter --output`, or any log that `clock` reads
    #[arg(long, value_name = "FILE", conflicts_with_all = ["jitter", "skew"])]
    pub(crate) jitter_file: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) topic: TopicArgs,
    /// Relative rate error of the clock, e.g. 1e-4; positive: slow, negative: fast
    #[arg(
        long,
        value_name = "PART",
        value_parser = finite_number,
        allow_hyphen_values = true
    )]
    pub(super) skew: Option<f64>,
    /// Probability that a command is lost (0 to below 1)
    #[arg(
        long,
        value_name = "P",
        value_parser = finite_number,
        allow_hyphen_values = true
    )]
    pub(super) loss: Option<f64>,
    /// Weights of the mean cost QQ·q² + VV·v² + UU·u² under noise [default: the energy, ½(ω²q² + v²)]
    #[arg(
        long,
        value_name = "QQ,VV,UU",
        value_parser = weights,
        requires = "feedback",
        allow_hyphen_values = true
    )]
    pub(super) cost_weights: Option<LqrWeights>,
    /// Largest deviation from --q from which the loop must return, in m or rad
    #[arg(
        long,
        value_name = "DISTANCE",
        value_parser = finite_number,
        requires = "feedback",
        default_value = "0.1",
        allow_hyphen_values = true
    )]
    pub(super) deviation: f64,
    /// Largest error, of one of energy, phase, trajectory or cost, e.g. energy=1e-6
    #[arg(
        long,
        value_name = "KIND=ERROR",
        value_parser = tolerance,
        default_value = "trajectory=1e-3",
        allow_hyphen_values = true
    )]
    pub(super) tolerance: ToleranceArg,
    /// Duration over which --tolerance holds, in s, also as 10min
    #[arg(
        long,
        value_name = "SECONDS",
        value_parser = time,
        default_value = "10",
        allow_hyphen_values = true
    )]
    pub(super) horizon: f64,
    /// Write an HTML page with a stability map to FILE
    #[arg(long, value_name = "FILE")]
    pub(crate) page: Option<PathBuf>,
    /// Print the result as JSON, with all digits
    #[arg(long)]
    pub(crate) json: bool,
    /// Print the whole text: every limit with its command, all integrators, margins and deviations
    #[arg(long, short)]
    pub(crate) verbose: bool,
    /// Print a request file with comments, and exit
    #[arg(long, conflicts_with_all = ["config", "page", "json", "jitter_file"], conflicts_with_all = REQUEST_OPTIONS)]
    pub(crate) print_config: bool,
}

/// Options that conflict with a request file.
const REQUEST_OPTIONS: [&str; 16] = [
    "plant",
    "lqr",
    "gain",
    "system",
    "force",
    "set",
    "q",
    "start",
    "v",
    "feedback",
    "period",
    "period_of_rate",
    "cost_weights",
    "deviation",
    "tolerance",
    "horizon",
];

const USAGE: &str = "\
libration advise --system <NAME> [OPTIONS]
       libration advise --system <FILE> [--lqr <STATES/INPUTS>] [OPTIONS]
       libration advise --plant <FILE> --lqr <STATES/INPUTS> [OPTIONS]
       libration advise --config <FILE> [OPTIONS]
       libration advise --print-config";

const EXAMPLES: &str = "\
Examples:
  libration advise --system oscillator --set omega2=10 --feedback 10,2 --period 0.01 \\
      --latency 0.02 --jitter gaussian:0.05 --loss 0.01
  libration advise --system kepler --tolerance energy=1e-6 --horizon 100
  libration advise --system cart_pole.toml --tolerance trajectory=1e-3 --horizon 5
  libration advise --system cart_pole.toml --lqr 1,10,0,1/0.1 --period 0.02 --latency 0.03
  libration advise --plant drive.toml --lqr 10,1,0,0/0.1 --latency 0.003 --output-latency 0.001
  libration advise --print-config > mine.toml
  libration advise --config mine.toml --jitter-file robot.csv --page budget.html

The limits are those of the loop linearised at --q, with one exact step of the plant per period.
A simulation of the loop contains all imperfections at once. --verbose prints the whole text.
The exit code is 1 if the loop with the stated values is unstable or exceeds the tolerance, or if no
integrator is accurate enough.";

/// The value of `--tolerance`.
#[derive(Clone, Copy, Debug)]
pub(super) struct ToleranceArg(pub(super) Tolerance);

impl AdviseArgs {
    /// Returns the stated period of the loop in s.
    pub(super) fn period(&self) -> Option<f64> {
        self.period.or(self.period_of_rate)
    }

    /// Returns the request with the timing options in place of its own.
    pub(crate) fn with_timing(&self, mut request: Request) -> Result<Request, Failure> {
        let Some(control) = &mut request.control else {
            let given = [
                (self.period.is_some(), "period"),
                (self.period_of_rate.is_some(), "rate"),
                (!self.latency.is_empty(), "latency"),
                (self.jitter.is_some(), "jitter"),
                (self.skew.is_some(), "skew"),
                (self.loss.is_some(), "loss"),
            ];
            return match given.into_iter().find(|(given, _)| *given) {
                Some((_, flag)) => Err(Failure::usage(format!(
                    "--{flag} is given, but there is no loop; expected --feedback, or a controller in the file"
                ))),
                None => Ok(request),
            };
        };
        control.latency = match self.latency[..] {
            [] => control.latency,
            [latency] => seconds(latency, control.period),
            _ => {
                return Err(Failure::usage(format!(
                    "--latency has {} values, but the loop has one input; expected one value",
                    self.latency.len()
                )));
            }
        };
        match (self.jitter, &control.record) {
            (Some(jitter), Some(_)) => {
                (control.jitter, control.record, control.skew) = (jitter, None, 0.0);
            }
            (Some(jitter), None) => control.jitter = jitter,
            (None, Some(_)) if self.skew.is_some() => {
                return Err(Failure::usage(
                    "--skew is given, but the time stamps of the file determine the skew",
                ));
            }
            (None, _) => {}
        }
        control.skew = self.skew.unwrap_or(control.skew);
        control.loss = self.loss.unwrap_or(control.loss);
        Ok(request)
    }
}

/// A latency in s.
pub(super) fn seconds(latency: LatencyOption, period: f64) -> f64 {
    match latency {
        LatencyOption::Seconds(seconds) => seconds,
        LatencyOption::Steps(steps) => steps * period,
    }
}

fn finite_number(text: &str) -> Result<f64, String> {
    finite(text).ok_or_else(|| "expected a finite number".to_owned())
}

fn tolerance(text: &str) -> Result<ToleranceArg, String> {
    let rule =
        "expected energy, phase, trajectory or cost, and a number greater than 0, e.g. energy=1e-6";
    let (name, most) = text.split_once('=').ok_or(rule)?;
    let of = Measure::ALL.into_iter().find(|measure| measure.name() == name.trim()).ok_or(rule)?;
    let most = finite(most).filter(|most| *most > 0.0).ok_or(rule)?;
    Ok(ToleranceArg(Tolerance { of, most }))
}
