//! Arguments of `bench`.

use std::path::PathBuf;

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use libration::ensemble::InstructionSet;
use libration_study::Effort;
use libration_study_batch::bench::{BenchFloat, Implementation, RolloutCase, RolloutTask};

use super::number::count;
use super::{efforts, simd};

/// Arguments of `bench`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct BenchArgs {
    /// Measure only these implementations [default: all, and the limits of the machine]
    #[arg(long, value_name = "NAME", value_delimiter = ',', value_parser = implementations())]
    pub(crate) implementation: Vec<Implementation>,
    /// Numbers of trajectories for --implementation [default: 1000,100000,10000000]
    #[arg(
        long = "num-trajectories",
        value_name = "N",
        value_delimiter = ',',
        value_parser = count,
        requires = "implementation",
        conflicts_with = "rollouts",
        allow_hyphen_values = true
    )]
    pub(crate) count: Vec<usize>,
    /// Float types for --implementation [default: f32,f64]
    #[arg(
        long = "dtype",
        value_name = "TYPE",
        value_delimiter = ',',
        value_parser = floats(),
        requires = "implementation",
        conflicts_with = "rollouts"
    )]
    pub(crate) dtype: Vec<BenchFloat>,
    /// Measure rollouts of environments, relative to a fill of the same memory
    #[arg(long, conflicts_with = "implementation")]
    pub(crate) rollouts: bool,
    /// Environments × horizon for --rollouts, e.g. 4096x1024 [default: the cases of the report and a swing-up]
    #[arg(
        long,
        value_name = "NxT",
        value_delimiter = ',',
        value_parser = rollout_case,
        requires = "rollouts",
        allow_hyphen_values = true
    )]
    pub(crate) case: Vec<RolloutCase>,
    /// Measure replay buffers, data sets and checkpoints, relative to copies of the same bytes
    #[arg(long, conflicts_with_all = ["implementation", "rollouts"])]
    pub(crate) storage: bool,
    /// Folder for the files of --storage [default: the folder for temporary files]
    #[arg(long, value_name = "DIR", requires = "storage")]
    pub(crate) folder: Option<PathBuf>,
    /// Instruction set [default: LIBRATION_SIMD, or the widest of this processor]
    #[arg(long, value_name = "SET", value_parser = simd::instruction_sets())]
    pub(crate) simd: Option<InstructionSet>,
    /// Effort of the run
    #[arg(long, value_parser = efforts(), default_value = "quick")]
    pub(crate) effort: Effort,
    /// Print the result as JSON
    #[arg(long)]
    pub(crate) json: bool,
}

const EXAMPLES: &str = "\
Examples:
  libration bench                                  speed of simulations and hardware limits
  libration bench --effort standard --json > machine.json
  libration bench --implementation fused,threads --num-trajectories 1e3,1e5,1e7 --dtype f32
  libration bench --rollouts --effort standard     rollouts relative to the memory bandwidth
  libration bench --storage --folder /data         data sets relative to the disk

All implementations advance harmonic oscillators by symplectic Euler and give the same bits.
Rates are medians over repetitions; spread is their interquartile range.
A target that a ratio of speeds does not reach is told and fails nothing: it is the machine's.";

fn implementations() -> impl TypedValueParser<Value = Implementation> {
    let value = |one: Implementation| PossibleValue::new(one.name()).help(one.summary());
    PossibleValuesParser::new(Implementation::ALL.map(value))
        .try_map(|name| Implementation::from_name(&name).ok_or("unknown implementation"))
}

fn floats() -> impl TypedValueParser<Value = BenchFloat> {
    let value = |float: BenchFloat| PossibleValue::new(float.name()).alias(float.dtype());
    PossibleValuesParser::new(BenchFloat::ALL.map(value))
        .try_map(|name| BenchFloat::from_name(&name).ok_or("unknown float type"))
}

/// Parses `ENVIRONMENTSxHORIZON`.
fn rollout_case(text: &str) -> Result<RolloutCase, String> {
    let shape = || "expected environments × horizon, e.g. 4096x1024".to_owned();
    let (environments, horizon) = text.split_once(['x', '×']).ok_or_else(shape)?;
    let [environments, horizon] = [environments, horizon].map(count);
    let (environments, horizon) = (environments?, horizon?);
    let case = RolloutCase { task: RolloutTask::Regulate, environments, horizon };
    case.check().map_err(|error| error.to_string())?;
    Ok(case)
}
