//! Arguments of `analyze`.

use clap::Args;

use super::number::{criterion, forecast_steps};
use super::timing::{CostArgs, TimingArgs};
use super::{StepArgs, SystemArgs};

/// Arguments of `analyze`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct AnalyzeArgs {
    #[command(flatten)]
    pub(crate) system: SystemArgs,
    #[command(flatten)]
    pub(crate) step: StepArgs,
    #[command(flatten)]
    pub(crate) timing: TimingArgs,
    #[command(flatten)]
    pub(crate) cost: CostArgs,
    /// Number of steps for the largest energy drift (linear systems: up to 1e15)
    #[arg(
        long,
        value_name = "N",
        default_value = "1000000",
        value_parser = forecast_steps,
        allow_hyphen_values = true
    )]
    pub(crate) steps: u64,
    /// Print the largest dt with a relative energy drift below DRIFT over --steps (oscillator; worst phase of the orbit)
    #[arg(long, value_name = "DRIFT", value_parser = criterion, allow_hyphen_values = true)]
    pub(crate) max_drift: Option<f64>,
    /// Print the largest dt with |q| below LENGTH over --steps (oscillator; worst phase of the orbit)
    #[arg(long, value_name = "LENGTH", value_parser = criterion, allow_hyphen_values = true)]
    pub(crate) max_amplitude: Option<f64>,
    /// Print the largest dt with an error below ERROR times the amplitude over --steps (oscillator; any start)
    #[arg(long, value_name = "ERROR", value_parser = criterion, allow_hyphen_values = true)]
    pub(crate) max_error: Option<f64>,
    /// Print the result as JSON, with all digits
    #[arg(long)]
    pub(crate) json: bool,
}

const EXAMPLES: &str = "\
Examples:
  libration analyze --system oscillator --set omega2=10 --integrator rk4 --dt 0.01
  libration analyze --system oscillator --integrator velocity-verlet --dt 0.01 --max-drift 1e-3
  libration analyze --system oscillator --set omega2=10 --integrator exact --dt 0.01 \
                    --feedback 10,2 --latency 0.015 --jitter gaussian:0.1
  libration analyze --system pendulum --q 2.5 --integrator velocity-verlet --dt 0.05 --json

For a nonlinear system, the matrix and the eigenvalues are those of one step linearised about --q, --v.
With --feedback the rows form blocks: one step of the plant without feedback, the closed loop, and the
closed loop with jitter, skew and losses. In JSON, `spectral_radius` is that of the plant and
`closed_loop_spectral_radius` is that of the loop with its latency.
The critical latency and the stable latencies between whole steps use λᵈ, as textbooks do. The limit \"of split
steps\" lets a command that arrives within a step split that step, as the spectral radius of the loop and
simulations do. The cost is the stationary mean under white noise of the acceleration, of unit intensity:
over continuous time for exact steps, else over the steps of the integrator, with constant noise in each.
With --skew half of the clocks are slow by its rms, half are fast. Second moments include latency, jitter
and losses, for a clock at its nominal rate and a latency of at most 90 steps. The exponent of a typical
run is not available with a latency or losses.";
