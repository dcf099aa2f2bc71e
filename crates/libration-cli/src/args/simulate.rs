//! What `simulate` takes.

use std::path::PathBuf;

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use libration::ensemble::InstructionSet;
use libration_analyze::trajectory::{FloatType, Format};

use super::number::{count, trajectory_steps, whole_number};
use super::timing::TimingArgs;
use super::{StepArgs, SystemArgs, simd};

/// What `simulate` takes.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct SimulateArgs {
    #[command(flatten)]
    pub(crate) system: SystemArgs,
    #[command(flatten)]
    pub(crate) step: StepArgs,
    /// Number of steps, up to 2^53; --every bounds the rows
    #[arg(long, value_name = "N", value_parser = trajectory_steps, allow_hyphen_values = true)]
    pub(crate) steps: u64,
    /// Float type of the state, the parameters and every operation
    #[arg(long, value_name = "TYPE", value_parser = float_types(), default_value = "f64")]
    pub(crate) float: FloatType,
    /// Write each N-th step, besides the start and the last step
    #[arg(
        long,
        value_name = "N",
        value_parser = every,
        allow_hyphen_values = true,
        default_value = "1"
    )]
    pub(crate) every: u64,
    /// Simulate N trajectories at once, with a column `trajectory` (float f64 or f32)
    #[arg(long, value_name = "N", value_parser = count, allow_hyphen_values = true)]
    pub(crate) count: Option<usize>,
    /// Let starts differ: from 1 - S times the start for the first trajectory to 1 + S for the last
    #[arg(
        long,
        value_name = "S",
        requires = "count",
        allow_hyphen_values = true,
        default_value = "0"
    )]
    pub(crate) spread: f64,
    /// Instruction set of the trajectories [default: the widest of this processor, or
    /// LIBRATION_SIMD]
    #[arg(long, value_name = "SET", value_parser = simd::instruction_sets(), requires = "count")]
    pub(crate) simd: Option<InstructionSet>,
    /// Threads of the trajectories; 0 for as many as there are cores
    #[arg(long, value_name = "N", requires = "count", default_value = "0")]
    pub(crate) threads: usize,
    #[command(flatten)]
    pub(crate) timing: TimingArgs,
    /// Steps as long as those between the time stamps of a loop that ran, in s: one on each line, up to a comma, with `#` before
    /// comments and perhaps a name above; --dt is the step that these are multiples of
    #[arg(long, value_name = "FILE")]
    pub(crate) time_stamps: Option<PathBuf>,
    /// Seed of all that is random: --jitter and --skew
    #[arg(long, value_name = "N", value_parser = seed, allow_hyphen_values = true, default_value = "0")]
    pub(crate) seed: u64,
    /// Format of the rows [default: that of the extension of --output, or csv]
    #[arg(long, value_parser = formats())]
    pub(crate) format: Option<Format>,
    /// File to write, whole or not at all; one that is replaced keeps its permissions, owner and links; one with several hard links or
    /// of another owner is filled in place [default: standard output]
    #[arg(long, short, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
}

const EXAMPLES: &str = "\
Examples:
  libration simulate --system oscillator --set omega2=10 --integrator rk4 --dt 0.01 --steps 1000
  libration simulate --system kepler --q 0.4,0 --v 0,2 --integrator leapfrog --dt 0.01 \\
      --steps 1e6 --every 1e3 --output orbit.parquet
  libration simulate --system pendulum --integrator velocity-verlet --dt 0.01 --steps 1e4 \\
      --every 1e4 --count 1e5 --spread 0.5 --float f32 --output swings.npy
  libration simulate --system oscillator --integrator velocity-verlet --dt 0.01 --steps 2e3 \\
      --feedback 10,2 --latency 0.015 --jitter gaussian:0.1 --count 100 --seed 7 --output loop.csv

The columns are step, t, q0, …, v0, …, energy. A state that overflows ends the rows with a note;
with --count, --feedback, --jitter, --skew or --time-stamps rows go on, and the note says how many
overflowed. With --jitter, --skew or --time-stamps, t is the time by a perfect clock. Before the first command arrives none acts.
With --count the first column is trajectory; each has the bits that it would have alone, whatever
--simd and --threads.";

/// Reads a stride; also as `1e3`.
fn every(text: &str) -> Result<u64, String> {
    let stride = whole_number(text).and_then(|n| u64::try_from(n).ok()).filter(|&n| n >= 1);
    stride.ok_or_else(|| "it must be a whole number of at least 1".to_owned())
}

/// Reads a seed.
fn seed(text: &str) -> Result<u64, String> {
    let seed = whole_number(text).and_then(|n| u64::try_from(n).ok());
    seed.ok_or_else(|| format!("it must be a whole number from 0 to {}", u64::MAX))
}

fn float_types() -> impl TypedValueParser<Value = FloatType> {
    PossibleValuesParser::new(FloatType::ALL.map(FloatType::name))
        .try_map(|name| FloatType::from_name(&name).ok_or("unknown float type"))
}

fn formats() -> impl TypedValueParser<Value = Format> {
    let value = |format: Format| PossibleValue::new(format.name()).help(format.summary());
    PossibleValuesParser::new(Format::ALL.map(value))
        .try_map(|name| Format::from_name(&name).ok_or("unknown format"))
}
