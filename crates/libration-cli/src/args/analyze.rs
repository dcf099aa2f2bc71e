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
  libration analyze --system oscillator --set omega2=10 --integrator exact --dt 0.01 \\
      --feedback 10,2 --latency 0.015 --jitter gaussian:0.1
  libration analyze --system pendulum --q 2.5 --integrator velocity-verlet --dt 0.05 --json

For a nonlinear system, the step is linearised about --q, --v.
With --feedback there are three blocks of rows: one step of the plant without feedback; the closed
loop; the closed loop with jitter, skew and losses. In JSON, `spectral_radius` is that of the plant
and `closed_loop_spectral_radius` that of the loop with its latency.

Critical latency: for a latency of d steps the characteristic polynomial contains λᵈ, also for a
fractional d. The row \"of split steps\" takes steps as simulations do: a command that arrives
within a step splits it in two.
Cost: the stationary mean under white acceleration noise of unit intensity. With `exact` it is the
mean over continuous time, otherwise over the steps, with constant noise in each step. With --skew
it is the mean of two clocks, one slow and one fast by the rms.
Second moments: with latency (at most 90 steps), jitter and losses, for a clock at its nominal rate.
The Lyapunov exponent (growth of a typical run) is not available with a latency or losses.";
