//! What `bench` takes.

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use libration::ensemble::InstructionSet;
use libration_lab::Effort;
use libration_lab::bench::{BenchFloat, Implementation};

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
        allow_hyphen_values = true
    )]
    pub(crate) count: Vec<usize>,
    /// Float types for --implementation [default: both]
    #[arg(
        long,
        value_name = "TYPE",
        value_delimiter = ',',
        value_parser = floats(),
        requires = "implementation"
    )]
    pub(crate) float: Vec<BenchFloat>,
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

All implementations advance harmonic oscillators by symplectic Euler and give the same bits.
Rates are medians; of each it is said how far the quartiles of its repeats lie apart.";

fn implementations() -> impl TypedValueParser<Value = Implementation> {
    let value = |one: Implementation| PossibleValue::new(one.name()).help(one.summary());
    PossibleValuesParser::new(Implementation::ALL.map(value))
        .try_map(|name| Implementation::from_name(&name).ok_or("unknown implementation"))
}

fn floats() -> impl TypedValueParser<Value = BenchFloat> {
    PossibleValuesParser::new(BenchFloat::ALL.map(BenchFloat::name))
        .try_map(|name| BenchFloat::from_name(&name).ok_or("unknown float type"))
}
