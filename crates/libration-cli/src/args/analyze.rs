//! What `analyze` takes.

use clap::Args;

use super::number::{criterion, forecast_steps};
use super::timing::{CostArgs, TimingArgs};
use super::{StepArgs, SystemArgs};

/// What theory says of one step.
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
    /// Number of steps over which the largest energy drift is taken; of a linear system up to 1e15
    #[arg(
        long,
        value_name = "N",
        default_value = "1000000",
        value_parser = forecast_steps,
        allow_hyphen_values = true
    )]
    pub(crate) steps: u64,
    /// Also say the largest dt whose relative energy drift stays below this over --steps, whatever phase
    /// of its orbit a run visits (oscillator)
    #[arg(long, value_name = "DRIFT", value_parser = criterion, allow_hyphen_values = true)]
    pub(crate) max_drift: Option<f64>,
    /// Also say the largest dt at which |q| stays below this over --steps, whatever phase of its orbit a
    /// run visits (oscillator)
    #[arg(long, value_name = "LENGTH", value_parser = criterion, allow_hyphen_values = true)]
    pub(crate) max_amplitude: Option<f64>,
    /// Also say the largest dt whose error stays below this part of the amplitude over --steps, from any
    /// start (oscillator)
    #[arg(long, value_name = "ERROR", value_parser = criterion, allow_hyphen_values = true)]
    pub(crate) max_error: Option<f64>,
    /// Print JSON, with all digits
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

Of a nonlinear system, matrix and eigenvalues are those of one step linearised about --q, --v.
With --feedback rows stand in blocks: what holds of one step of the plant without feedback, of the closed
loop, and of the closed loop under jitter, skew and losses. In JSON `spectral_radius` is that of the plant,
`closed_loop_spectral_radius` that of the loop with its latency.
Between whole steps critical latency and stable latencies follow the textbook's λᵈ; the end of
split steps is where a command that arrives within a step splits it, as the spectral radius of the loop
and simulations have it. The cost is the stationary mean under white noise of the acceleration of unit
intensity: of exact steps over continuous time, of an integrator over its steps, with the noise
held through each; half the clocks of --skew are slow by its rms, half fast. Second moments are those of
the loop with its latency, jitter and losses, of a clock at its nominal rate; they are known up to a
latency of 90 steps. The exponent of a typical run is not known with a latency or losses.";
