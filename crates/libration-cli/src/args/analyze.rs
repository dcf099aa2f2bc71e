//! What `analyze` takes.

use clap::Args;

use super::number::steps;
use super::{StepArgs, SystemArgs};

/// What theory says of one step.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct AnalyzeArgs {
    #[command(flatten)]
    pub(crate) system: SystemArgs,
    #[command(flatten)]
    pub(crate) step: StepArgs,
    /// Number of steps over which the largest energy drift is taken
    #[arg(long, value_name = "N", default_value = "1000000", value_parser = steps, allow_hyphen_values = true)]
    pub(crate) steps: u64,
    /// Print JSON, with all digits
    #[arg(long)]
    pub(crate) json: bool,
}

const EXAMPLES: &str = "\
Examples:
  libration analyze --system oscillator --set omega2=10 --integrator rk4 --dt 0.01
  libration analyze --system pendulum --q 2.5 --integrator velocity-verlet --dt 0.05 --json

Of a nonlinear system, matrix and eigenvalues are those of one step linearised about --q, --v.";
