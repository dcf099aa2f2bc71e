//! What `bench` takes.

use std::path::PathBuf;

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use libration::ensemble::InstructionSet;
use libration_study::Effort;
use libration_study_batch::bench::{BenchFloat, Implementation, RolloutCase, RolloutTask};

use super::number::count;
use super::{efforts, simd};

/// What `bench` takes.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct BenchArgs {
    /// Time these implementations alone [default: all of them, and what limits them]
    #[arg(long, value_name = "NAME", value_delimiter = ',', value_parser = implementations())]
    pub(crate) implementation: Vec<Implementation>,
    /// Numbers of trajectories for --implementation [default: 1000, 100000 and 10000000]
    #[arg(
        long,
        value_name = "N",
        value_delimiter = ',',
        value_parser = count,
        requires = "implementation",
        conflicts_with = "rollouts",
        allow_hyphen_values = true
    )]
    pub(crate) count: Vec<usize>,
    /// Float types for --implementation [default: both]
    #[arg(
        long,
        value_name = "TYPE",
        value_delimiter = ',',
        value_parser = floats(),
        requires = "implementation",
        conflicts_with = "rollouts"
    )]
    pub(crate) float: Vec<BenchFloat>,
    /// Time rollouts of environments, against fills of as much memory
    #[arg(long, conflicts_with = "implementation")]
    pub(crate) rollouts: bool,
    /// Environments and horizons for --rollouts, as in 4096x1024 [default: those of the report, and a swing-up]
    #[arg(
        long,
        value_name = "NxT",
        value_delimiter = ',',
        value_parser = rollout_case,
        requires = "rollouts",
        allow_hyphen_values = true
    )]
    pub(crate) case: Vec<RolloutCase>,
    /// Time replay buffers, data sets and checkpoints, against copies of as many bytes in memory and to the disk
    #[arg(long, conflicts_with_all = ["implementation", "rollouts"])]
    pub(crate) storage: bool,
    /// Where --storage writes [default: the system's folder for temporary files]
    #[arg(long, value_name = "DIR", requires = "storage")]
    pub(crate) folder: Option<PathBuf>,
    /// Instruction set [default: the widest of this processor, or LIBRATION_SIMD]
    #[arg(long, value_name = "SET", value_parser = simd::instruction_sets())]
    pub(crate) simd: Option<InstructionSet>,
    /// How much work the run may take
    #[arg(long, value_parser = efforts(), default_value = "quick")]
    pub(crate) effort: Effort,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

const EXAMPLES: &str = "\
Examples:
  libration bench                                  what this machine can do, and what limits it
  libration bench --effort standard --json > machine.json
  libration bench --implementation fused,threads --count 1e3,1e5,1e7 --float f32
  libration bench --rollouts --effort standard     how near to the memory rollouts come
  libration bench --storage --folder /data         how near to the disk data sets come

All implementations advance harmonic oscillators by symplectic Euler and give the same bits.
Rates are medians; of each it is said how far the quartiles of its repeats lie apart.
Exit code 1 if a ratio of speeds misses its prediction.";

fn implementations() -> impl TypedValueParser<Value = Implementation> {
    let value = |one: Implementation| PossibleValue::new(one.name()).help(one.summary());
    PossibleValuesParser::new(Implementation::ALL.map(value))
        .try_map(|name| Implementation::from_name(&name).ok_or("unknown implementation"))
}

fn floats() -> impl TypedValueParser<Value = BenchFloat> {
    PossibleValuesParser::new(BenchFloat::ALL.map(BenchFloat::name))
        .try_map(|name| BenchFloat::from_name(&name).ok_or("unknown float type"))
}

/// A case of so many environments over such a horizon.
fn rollout_case(text: &str) -> Result<RolloutCase, String> {
    let shape = || "it must be environments × horizon, as in 4096x1024".to_owned();
    let (environments, horizon) = text.split_once(['x', '×']).ok_or_else(shape)?;
    let [environments, horizon] = [environments, horizon].map(count);
    let (environments, horizon) = (environments?, horizon?);
    let case = RolloutCase { task: RolloutTask::Regulate, environments, horizon };
    case.check().map_err(|error| error.to_string())?;
    Ok(case)
}
