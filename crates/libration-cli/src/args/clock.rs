//! Arguments of `clock`.

use std::path::PathBuf;

use clap::Args;

use super::TopicArgs;

/// Arguments of `clock`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct ClockArgs {
    /// Log: MCAP, ROS bag, ULog, CSV or other text, cyclictest, Parquet, NumPy; its first bytes determine the format
    #[arg(value_name = "FILE")]
    pub(crate) file: PathBuf,
    #[command(flatten)]
    pub(crate) topic: TopicArgs,
    /// Later topic, for the latency from --topic to it
    #[arg(long, value_name = "NAME", requires = "topic")]
    pub(crate) against: Option<String>,
    /// Loop, as for `advise`, to compute what the clock and the latency do to it
    #[arg(long, value_name = "FILE")]
    pub(crate) config: Option<PathBuf>,
    /// Write an HTML page to FILE
    #[arg(long, value_name = "FILE")]
    pub(crate) page: Option<PathBuf>,
    /// Print the result as JSON, with all digits
    #[arg(long)]
    pub(crate) json: bool,
}

const EXAMPLES: &str = "\
Examples:
  libration clock run.mcap
  libration clock run.mcap --topic /joint_states --clock header
  libration clock run.mcap --topic /joint_states --against /cmd --page clock.html
  libration clock run.mcap --topic /joint_states --against /cmd --config loop.toml

The latency is that between messages with equal header stamps, or from the nearest preceding message.
The exit code is 1 if the loop of --config is unstable with this clock and latency.";
