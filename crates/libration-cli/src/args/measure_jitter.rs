//! Arguments of `measure-jitter`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use libration_advise::jitter_measurement::{Plan, Priority};
use libration_settings::duration;

use super::{TopicArgs, number};

/// Arguments of `measure-jitter`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct MeasureJitterArgs {
    /// Rate of the loop in Hz, also as 0.5kHz
    #[arg(long, value_name = "HZ", value_parser = rate, default_value = "1000", allow_hyphen_values = true)]
    rate: f64,
    /// Duration for each priority in s, also as 1min
    #[arg(long, value_name = "S", value_parser = number::time, default_value = "10", allow_hyphen_values = true)]
    seconds: f64,
    /// Keep all cores busy during the measurement
    #[arg(long)]
    load: bool,
    /// Priority of the thread: ordinary, raised (real time; requires permission) or both in turn
    #[arg(long, value_name = "WHICH", default_value = "both")]
    priority: PriorityChoice,
    /// Write the time stamps to FILE as CSV, with a column `time_ns` (with --priority both: those of ordinary)
    #[arg(long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// Analyze the time stamps of FILE without a measurement: any log that `clock` reads
    #[arg(
        long,
        value_name = "FILE",
        conflicts_with_all = ["rate", "seconds", "load", "priority", "output"]
    )]
    pub(crate) from: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) topic: TopicArgs,
    /// Print the result as JSON, with all digits
    #[arg(long)]
    pub(crate) json: bool,
}

const EXAMPLES: &str = "\
Examples:
  libration measure-jitter
  libration measure-jitter --rate 500 --seconds 60 --load --output robot.csv
  libration measure-jitter --from candump.log
  libration simulate --system oscillator --integrator velocity-verlet --dt 0.002 \\
      --steps 29000 --time-stamps robot.csv

A thread sleeps until periodic deadlines of the monotonic clock, and records its wake-up times.
`simulate --time-stamps`, `advise --jitter-file` and the key `[jitter] time_stamps` of `lab`
replay these times.";

impl MeasureJitterArgs {
    /// Returns the plan of the measurement.
    pub(crate) fn plan(&self) -> Plan {
        Plan { rate: self.rate, seconds: self.seconds, load: self.load }
    }

    /// Returns the priorities, in the order of measurement.
    pub(crate) fn priorities(&self) -> &'static [Priority] {
        match self.priority {
            PriorityChoice::Ordinary => &[Priority::Ordinary],
            PriorityChoice::Raised => &[Priority::Raised],
            PriorityChoice::Both => &[Priority::Ordinary, Priority::Raised],
        }
    }
}

/// The value of `--priority`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum PriorityChoice {
    Ordinary,
    Raised,
    Both,
}

fn rate(text: &str) -> Result<f64, String> {
    let rate = duration::rate(text);
    rate.ok_or_else(|| "expected a rate in Hz, e.g. 500, 500Hz or 0.5kHz".to_owned())
}
