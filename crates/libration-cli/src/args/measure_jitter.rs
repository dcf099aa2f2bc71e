//! What `measure-jitter` takes.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use libration_advise::wakeups::{Plan, Priority};

/// What `measure-jitter` takes.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct MeasureJitterArgs {
    /// How often the loop wakes up in a second
    #[arg(long, value_name = "HZ", default_value = "1000", allow_hyphen_values = true)]
    rate: f64,
    /// For how many seconds, with each priority
    #[arg(long, value_name = "S", default_value = "10", allow_hyphen_values = true)]
    seconds: f64,
    /// Keep all cores busy meanwhile
    #[arg(long)]
    load: bool,
    /// With which priority: that of every program, one in real time (which the system must allow), or first the one and then the
    /// other
    #[arg(long, value_name = "WHICH", default_value = "both")]
    priority: Which,
    /// File for the time stamps, of ordinary priority unless --priority says raised: CSV, with a column `time_ns`
    #[arg(long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// Measure nothing: tell of the time stamps of a file, in seconds or nanoseconds, as a log has them
    #[arg(
        long,
        value_name = "FILE",
        conflicts_with_all = ["rate", "seconds", "load", "priority", "output"]
    )]
    pub(crate) from: Option<PathBuf>,
    /// Print JSON, with all digits
    #[arg(long)]
    pub(crate) json: bool,
}

const EXAMPLES: &str = "\
Examples:
  libration measure-jitter
  libration measure-jitter --rate 500 --seconds 60 --load --output robot.csv
  libration measure-jitter --from candump.log
  libration simulate --system oscillator --integrator velocity-verlet --dt 0.002 --steps 29000 \
                     --time-stamps robot.csv

A thread sleeps up to deadlines on a grid, by the monotonic clock, and notes when it woke up; it does nothing else.
What it measured is a clock: `simulate --time-stamps` replays it, and so does `[jitter] time_stamps` of a configuration.";

impl MeasureJitterArgs {
    /// What is measured.
    pub(crate) fn plan(&self) -> Plan {
        Plan { rate: self.rate, seconds: self.seconds, load: self.load }
    }

    /// With which priorities, one after the other.
    pub(crate) fn priorities(&self) -> &'static [Priority] {
        match self.priority {
            Which::Ordinary => &[Priority::Ordinary],
            Which::Raised => &[Priority::Raised],
            Which::Both => &[Priority::Ordinary, Priority::Raised],
        }
    }
}

/// With which priority the loop runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Which {
    Ordinary,
    Raised,
    Both,
}
