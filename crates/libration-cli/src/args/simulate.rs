//! Arguments of `simulate`.

use std::path::PathBuf;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{ArgGroup, Args};
use libration::ensemble::InstructionSet;
use libration_analyze::adaptive::StepControl;
use libration_analyze::trajectory::{FloatType, Format};
use libration_settings::limits;

use super::number::{count, seed, time, trajectory_steps, whole_number};
use super::timing::TimingArgs;
use super::{LinearSimulationArgs, StepArgs, SystemArgs, TopicArgs, simd};
use crate::error::Failure;

/// Arguments of `simulate`.
#[derive(Args, Debug)]
#[command(
    after_help = EXAMPLES,
    override_usage = USAGE,
    group(ArgGroup::new("timed").args(["plant", "config", "feedback", "lqr", "gain"]).multiple(true))
)]
pub(crate) struct SimulateArgs {
    #[command(flatten)]
    pub(crate) system: Option<SystemArgs>,
    #[command(flatten)]
    pub(crate) step: Option<StepArgs>,
    #[command(flatten)]
    pub(crate) linear: LinearSimulationArgs,
    /// Number of steps (of a loop around a plant: of periods), up to 2^53; --save-every limits the number of rows
    #[arg(
        long,
        value_name = "N",
        value_parser = trajectory_steps,
        allow_hyphen_values = true,
        required_unless_present = "duration"
    )]
    steps: Option<u64>,
    /// Simulated time in place of --steps, in s, also as 10min: the steps that reach it
    #[arg(long, value_name = "TIME", value_parser = time, allow_hyphen_values = true, conflicts_with = "steps")]
    duration: Option<f64>,
    /// Let the length of the steps follow the forces: --dt is the first; see `docs/adaptive.md`
    #[arg(
        long,
        value_name = "CONTROL",
        value_parser = controls(),
        conflicts_with_all = ["count", "plant", "config", "feedback", "lqr", "gain", "time_stamps", "jitter", "skew", "spread", "seed", "threads", "simd"]
    )]
    pub(crate) adaptive: Option<StepControl>,
    /// Float type of the state, the parameters and every operation
    #[arg(long = "dtype", value_name = "TYPE", value_parser = float_types(), default_value = "f64")]
    pub(crate) dtype: FloatType,
    /// Write every N-th step, the start and the last step
    #[arg(
        long = "save-every",
        value_name = "N",
        value_parser = every,
        allow_hyphen_values = true,
        default_value = "1"
    )]
    pub(crate) every: u64,
    /// Number of trajectories; adds a column `trajectory`; requires --dtype f64 or f32
    #[arg(long = "num-trajectories", value_name = "N", value_parser = count, allow_hyphen_values = true)]
    pub(crate) count: Option<usize>,
    /// Scale the initial states linearly, from 1 - S (first trajectory) to 1 + S (last)
    #[arg(
        long,
        value_name = "S",
        requires = "count",
        allow_hyphen_values = true,
        default_value = "0"
    )]
    pub(crate) spread: f64,
    /// Instruction set of trajectories without a control loop [default: LIBRATION_SIMD, or the widest of this processor]
    #[arg(long, value_name = "SET", value_parser = simd::instruction_sets(), requires = "count")]
    pub(crate) simd: Option<InstructionSet>,
    /// Number of threads of the trajectories (0: one per core)
    #[arg(long, value_name = "N", requires = "count", default_value = "0")]
    pub(crate) threads: usize,
    #[command(flatten)]
    pub(crate) timing: TimingArgs,
    /// File of measured time stamps, as any log that `clock` reads; their intervals are the lengths of the steps
    #[arg(long, value_name = "FILE")]
    pub(crate) time_stamps: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) topic: TopicArgs,
    /// Seed of --jitter, --skew, --loss and --noise
    #[arg(long, value_name = "N", value_parser = seed, allow_hyphen_values = true, default_value = "0")]
    pub(crate) seed: u64,
    /// Format of the rows [default: by the extension of --output, or csv]
    #[arg(long, value_parser = formats())]
    pub(crate) format: Option<Format>,
    /// Write the rows to FILE; an existing file keeps its permissions, owner and links [default: standard output]
    #[arg(long, short, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
}

const USAGE: &str = "\
libration simulate --system <NAME> --integrator <NAME> --dt <SECONDS> --steps <N> [OPTIONS]
       libration simulate --plant <FILE> [--lqr <STATES/INPUTS>] --steps <N> [OPTIONS]
       libration simulate --system <FILE> --lqr <STATES/INPUTS> --steps <N> [OPTIONS]
       libration simulate --config <FILE> --steps <N> [OPTIONS]";

const EXAMPLES: &str = "\
Examples:
  libration simulate --system oscillator --set omega2=10 --integrator rk4 --dt 0.01 --steps 1000
  libration simulate --system kepler --q 0.4,0 --v 0,2 --integrator leapfrog --dt 0.01 \\
      --steps 1e6 --save-every 1e3 --output orbit.parquet
  libration simulate --system pendulum --integrator velocity-verlet --dt 0.01 --steps 1e4 \\
      --save-every 1e4 --num-trajectories 1e5 --spread 0.5 --dtype f32 --output swings.npy
  libration simulate --system oscillator --integrator velocity-verlet --dt 0.01 --steps 2e3 \\
      --feedback 10,2 --latency 0.015 --jitter gaussian:0.1 --num-trajectories 100 --seed 7 \\
      --output loop.csv
  libration simulate --plant drive.toml --lqr 1,100,0,1/0.1 --period 0.001 --latency 0.0008 \\
      --reference \"load angle=1\" --steps 500 --output step.csv

  libration simulate --system kepler --q 0.1,0 --v 0,4.36 --integrator leapfrog --dt 0.001 --steps 1e5 \
      --adaptive integrating --output orbit.csv

  libration simulate --system cart_pole.toml --lqr 1,10,0,1/0.1 --period 0.02 --latency 0.03 \\
      --steps 200 --output balance.csv

The columns are step, t, the coordinates by name, their velocities with a prime, states of first order, and the energy;
with --num-trajectories the first column is trajectory. If the energy of a single trajectory
grows although its forces add none, a warning says so (not with --adaptive and loops, nor of forces with time, kinks or jumps).
With --plant, --config, --lqr or --gain a row belongs to the beginning of a period. Its columns are step, t, the states,
`measured NAME` (what the controller reads), `input NAME` (what acts), and the cost so far.
If the state overflows, the rows end and a note says so. With --num-trajectories, --feedback, --jitter, --skew
or --time-stamps the rows continue, and the note states the number of overflows.
With --jitter, --skew or --time-stamps, t is the true time: the sum of the actual step lengths.
Until the first command arrives, the command is 0.
The bits of a trajectory are independent of --num-trajectories, --simd and --threads.
The output file appears only when it is complete.";

impl SimulateArgs {
    /// The number of steps of so many seconds, or of periods.
    ///
    /// # Errors
    /// If a duration is no time, or takes more steps than there may be.
    pub(crate) fn steps_of(&self, dt: f64) -> Result<u64, Failure> {
        let Some(duration) = self.duration else { return Ok(self.steps.unwrap_or_default()) };
        // The quotient of two rounded numbers may be a little above a whole number.
        let steps = (duration / dt * (1.0 - 2.0 * f64::EPSILON)).ceil();
        match steps >= 1.0 && limits::TRAJECTORY_STEPS.contains(&(steps as u64)) {
            true => Ok(steps as u64),
            false => Err(Failure::usage(format!(
                "--duration {duration} s is {steps} steps of {dt} s; expected {}",
                limits::trajectory_steps_allowed()
            ))),
        }
    }

    /// Whether a duration is given.
    pub(crate) fn has_duration(&self) -> bool {
        self.duration.is_some()
    }
}

/// The option that sets a field of a request.
pub(crate) fn option_of(field: &str) -> &str {
    match field {
        "count" => "num-trajectories",
        "every" => "save-every",
        same => same,
    }
}

/// Parses a stride; also as `1e3`.
pub(super) fn every(text: &str) -> Result<u64, String> {
    let stride = whole_number(text).and_then(|n| u64::try_from(n).ok()).filter(|&n| n >= 1);
    stride.ok_or_else(|| "expected a whole number of at least 1".to_owned())
}

fn controls() -> impl TypedValueParser<Value = StepControl> {
    let value = |control: StepControl| PossibleValue::new(control.name()).help(control.summary());
    PossibleValuesParser::new(StepControl::ALL.map(value))
        .try_map(|name| StepControl::from_name(&name).ok_or("unknown control"))
}

fn float_types() -> impl TypedValueParser<Value = FloatType> {
    let value = |float: FloatType| PossibleValue::new(float.name()).alias(float.dtype());
    PossibleValuesParser::new(FloatType::ALL.map(value))
        .try_map(|name| FloatType::from_name(&name).ok_or("unknown float type"))
}

pub(super) fn formats() -> impl TypedValueParser<Value = Format> {
    let value = |format: Format| PossibleValue::new(format.name()).help(format.summary());
    PossibleValuesParser::new(Format::ALL.map(value))
        .try_map(|name| Format::from_name(&name).ok_or("unknown format"))
}
