//! Arguments of `analyze`.

use clap::{ArgGroup, Args};

use libration::thermostat::LangevinMethod;
use libration_analyze::Stepping;

use super::number::{compared_time, criterion, forecast_steps, seed, time_step, tolerance};
use super::system::integrators;
use super::timing::{CostArgs, TimingArgs};
use super::{LinearAnalysisArgs, SystemArgs};

/// Arguments of `analyze`.
#[derive(Args, Debug)]
#[command(
    after_help = EXAMPLES,
    override_usage = USAGE,
    group(ArgGroup::new("timed").args(["plant", "config", "feedback"]).multiple(true))
)]
pub(crate) struct AnalyzeArgs {
    #[command(flatten)]
    pub(crate) system: Option<SystemArgs>,
    #[command(flatten)]
    pub(crate) linear: LinearAnalysisArgs,
    /// Name of the integrator, or `exact` for a linear system; see `libration list` [default with --plant or --config: all that apply]
    #[arg(
        long,
        value_name = "NAME",
        value_parser = integrators(),
        hide_possible_values = true,
        required_unless_present_any = ["plant", "config", "compare", "temperature"]
    )]
    pub(crate) integrator: Option<Stepping>,
    /// Time step in s, also as 2ms or 500Hz [default with --temperature: 1/ω of the fastest mode]
    #[arg(
        long,
        value_name = "SECONDS",
        value_parser = time_step,
        allow_hyphen_values = true,
        required_unless_present_any = ["plant", "config", "compare", "temperature"]
    )]
    pub(crate) dt: Option<f64>,
    #[command(flatten)]
    pub(crate) timing: TimingArgs,
    #[command(flatten)]
    pub(crate) cost: CostArgs,
    /// Number of steps of the motion and its energy drift (linear systems: up to 1e15) [default: 1000], or measured steps of each thermostat
    /// [default: 1000000]
    #[arg(long, value_name = "N", value_parser = forecast_steps, allow_hyphen_values = true)]
    pub(crate) steps: Option<u64>,
    /// Print the largest dt with a relative energy drift below DRIFT over --steps (oscillators; from the start, and from the worst one)
    #[arg(long, value_name = "DRIFT", value_parser = criterion, allow_hyphen_values = true)]
    pub(crate) max_drift: Option<f64>,
    /// Print the largest dt with |q| below LENGTH over --steps (oscillators; from the start)
    #[arg(long, value_name = "LENGTH", value_parser = criterion, allow_hyphen_values = true)]
    pub(crate) max_amplitude: Option<f64>,
    /// Print the largest dt with an error below ERROR times the amplitude over --steps (oscillators; from any start)
    #[arg(long, value_name = "ERROR", value_parser = criterion, allow_hyphen_values = true)]
    pub(crate) max_error: Option<f64>,
    /// Compare all explicit integrators on the motion from the start: the cheapest for --tolerance over --horizon
    #[arg(
        long,
        requires_all = ["tolerance", "horizon"],
        conflicts_with_all = [
            "integrator", "dt", "plant", "config", "feedback", "jitter", "steps", "cost_weights", "max_drift", "max_amplitude",
            "max_error"
        ]
    )]
    pub(crate) compare: bool,
    /// Largest error of a state after any step with --compare, relative to the largest size of that state (1e-13 to 0.1)
    #[arg(
        long,
        value_name = "ERROR",
        value_parser = tolerance,
        allow_hyphen_values = true,
        requires = "compare"
    )]
    pub(crate) tolerance: Option<f64>,
    /// Time of the motion with --compare, in s, also as 10min
    #[arg(
        long,
        value_name = "SECONDS",
        value_parser = compared_time,
        allow_hyphen_values = true,
        requires = "compare"
    )]
    pub(crate) horizon: Option<f64>,
    /// Temperatures of thermostats at the temperature kT (in units of the energy) and their bias by the time step
    #[arg(
        long,
        value_name = "KT",
        allow_hyphen_values = true,
        requires = "friction",
        conflicts_with_all = [
            "integrator", "plant", "config", "feedback", "max_drift", "max_amplitude", "max_error", "compare"
        ]
    )]
    pub(crate) temperature: Option<f64>,
    /// Friction of a thermostat in 1/s with --temperature
    #[arg(long, value_name = "GAMMA", allow_hyphen_values = true, requires = "temperature")]
    pub(crate) friction: Option<f64>,
    /// Word of A (drift), B (kick), O (friction and noise), or gjf, euler-maruyama; repeatable [default: the common ones]
    #[arg(long, value_name = "WORD", requires = "temperature")]
    pub(crate) thermostat: Vec<LangevinMethod>,
    /// Seed of the noise with --temperature [default: 0]
    #[arg(long, value_name = "N", value_parser = seed, requires = "temperature", allow_hyphen_values = true)]
    pub(crate) seed: Option<u64>,
    /// Print the result as JSON, with all digits
    #[arg(long)]
    pub(crate) json: bool,
    /// Print the whole text: matrices, all modes and integrators, with more digits
    #[arg(long, short)]
    pub(crate) verbose: bool,
}

impl AnalyzeArgs {
    /// Steps of a forecast, and of thermostats, without `--steps`.
    pub(crate) const FORECAST_STEPS: u64 = 1_000_000;
}

const USAGE: &str = "\
libration analyze --system <NAME> --integrator <NAME> --dt <SECONDS> [OPTIONS]
       libration analyze --system <NAME> --compare --tolerance <ERROR> --horizon <SECONDS>
       libration analyze --system <NAME> --temperature <KT> --friction <GAMMA> [--dt <SECONDS>] [--thermostat <WORD>]
       libration analyze --plant <FILE> [--dt <SECONDS>] [--integrator <NAME>] [--lqr <STATES/INPUTS>] [OPTIONS]
       libration analyze --config <FILE> [--dt <SECONDS>] [--integrator <NAME>] [OPTIONS]";

const EXAMPLES: &str = "\
Examples:
  libration analyze --system oscillator --set omega2=10 --integrator rk4 --dt 0.01
  libration analyze --system oscillator --integrator velocity-verlet --dt 0.01 --max-drift 1e-3
  libration analyze --system oscillator --set omega2=10 --integrator exact --dt 0.01 \\
      --feedback 10,2 --latency 0.015 --jitter gaussian:0.1
  libration analyze --system pendulum --q 2.5 --integrator velocity-verlet --dt 0.05 --json
  libration analyze --system kepler --compare --tolerance 1e-8 --horizon 100
  libration analyze --system pendulum --temperature 1 --friction 1 --dt 0.2 --thermostat BAOAB --thermostat OBABO
  libration analyze --plant drive.toml --dt 0.001
  libration analyze --plant drive.toml --dt 0.001 --integrator rk4
  libration analyze --plant drive.toml --lqr 1,100,0,1/0.1 --period 0.001 --latency 0.0008
  libration analyze --config examples/loops/two_mass_drive.toml --json

Linear plants (--plant, --config): the modes by name of their states; without a controller also the
time steps at which each integrator is stable, and with --dt what a step makes of each mode, predicted
and measured in f64 and f32. --integrator with --verbose prints each mode for itself. With a
controller: the modes, the growth, the cost and the deviations of the loop. docs/plants.md has the
keys of --json.

For a nonlinear system, the step is linearised about --q, --v.
The answer fits a screen. With --verbose and --feedback there are three blocks of rows: one step of
the plant without feedback; the closed loop; the closed loop with jitter, skew and losses. In JSON, `spectral_radius` is that of the plant
and `closed_loop_spectral_radius` that of the loop with its latency.

Critical latency: for a latency of d steps the characteristic polynomial contains λᵈ, also for a
fractional d. The row \"of split steps\" takes steps as simulations do: a command that arrives
within a step splits it in two.
Cost: the stationary mean under white acceleration noise of unit intensity. With `exact` it is the
mean over continuous time, otherwise over the steps, with constant noise in each step. With --skew
it is the mean of two clocks, one slow and one fast by the rms.
Second moments: with latency (at most 90 steps), jitter and losses, for a clock at its nominal rate.
The Lyapunov exponent (growth of a typical run) is not available with a latency or losses.";
