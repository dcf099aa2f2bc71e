//! The command line as types.

mod advice_request;
mod advise;
mod analyze;
mod audit;
mod bench;
mod bodies;
mod clock;
mod compare;
mod gains;
mod identify;
mod lab;
mod linear;
mod linear_analysis;
mod linear_simulation;
mod measure_jitter;
mod number;
mod probe;
mod quoted;
mod rollout;
mod serve;
pub(crate) mod simd;
mod simulate;
mod system;
mod timing;
mod topic;

use std::ffi::OsString;
use std::path::PathBuf;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, ColorChoice, CommandFactory, FromArgMatches, Parser, Subcommand};
use libration_settings::EquationExample;
use libration_study::Effort;

use crate::error::Failure;

pub(crate) use advise::AdviseArgs;
pub(crate) use analyze::AnalyzeArgs;
pub(crate) use audit::AuditArgs;
pub(crate) use bench::BenchArgs;
pub(crate) use bodies::BodiesArgs;
pub(crate) use clock::ClockArgs;
pub(crate) use compare::CompareArgs;
pub(crate) use gains::GainsArgs;
pub(crate) use identify::IdentifyArgs;
pub(crate) use lab::LabArgs;
pub(crate) use linear::LinearArgs;
pub(crate) use linear_analysis::LinearAnalysisArgs;
pub(crate) use linear_simulation::LinearSimulationArgs;
pub(crate) use measure_jitter::MeasureJitterArgs;
pub(crate) use number::Coordinates;
pub(crate) use probe::ProbeArgs;
pub(crate) use quoted::quoted;
pub(crate) use rollout::{JoinArgs, RolloutArgs, VerifyArgs};
pub(crate) use serve::ServeArgs;
pub(crate) use simulate::{SimulateArgs, option_of};
pub(crate) use system::{StepArgs, SystemArgs};
pub(crate) use timing::CostArgs;
pub(crate) use topic::{ClockName, TimeUnitName, TopicArgs};

/// Predict and measure the stability of simulations and control loops.
#[derive(Debug, Parser)]
#[command(name = "libration", version, propagate_version = true, max_term_width = 100)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// Print errors only, without progress and summary
    #[arg(long, short, global = true)]
    pub(crate) quiet: bool,
    /// Use of colour (auto: on a terminal, unless NO_COLOR is set)
    #[arg(long, global = true, value_name = "WHEN", default_value = "auto")]
    pub(crate) color: ColorChoice,
    #[command(subcommand)]
    pub(crate) command: Command,
}

const EXAMPLES: &str = "\
Examples:
  libration lab                              all studies, with the settings of the report
  libration lab drift --effort quick --open  one study in seconds, opened in the browser
  libration lab --print-config > mine.toml   the configuration, ready to edit
  libration lab --config mine.toml           all studies, with that configuration
  libration lab --system pendulum.toml       the studies of a system by its equations
  libration simulate --system oscillator --integrator rk4 --dt 0.01 --steps 1000
                                             a trajectory as CSV
  libration analyze --system oscillator --integrator rk4 --dt 0.01
                                             matrix, eigenvalues and stability of one step
  libration advise --system oscillator --feedback 10,2 --period 0.01 --latency 0.02
                                             limits of a control loop
  libration probe --command ./my_step --state 0,1 --dt 0.01
                                             an audit of the step of your simulator
  libration audit h1.csv h2.csv --energy E --dt 0.01,0.005
                                             what an energy drift is made of
  libration gains --mujoco robot.xml --dt 0.005
                                             the largest gains of its servos
  libration identify log.csv --command cmd --response q
                                             dead time and lag of a real loop, from its log
  libration bodies outer-solar-system --integrator wisdom-holman --dt 50 --steps 1e5
                                             planets, and the drift of their energy
  libration rollout --out data --transitions 1e8
                                             a data set of rollouts, as Parquet
  libration bench                            speed of simulations on this machine
  libration clock run.mcap --topic /cmd      the clock of a topic of a log
  libration measure-jitter --rate 500        wake-up times of a loop of 500 Hz
  libration list                             all studies, systems and integrators

Exit codes: 0 all verdicts are good; 1 a bad or unknown verdict, or a failed run; 2 invalid input;
            130 interrupted";

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Run studies and write a report
    Lab(LabArgs),
    /// Analyze one step: update matrix, eigenvalues, stability and drift; modes of linear plants and loops
    Analyze(AnalyzeArgs),
    /// Compute limits: integrator, time step, float type, latency, jitter, skew and losses
    Advise(AdviseArgs),
    /// Audit the step of any simulator: MuJoCo models, programs, matrices
    Probe(ProbeArgs),
    /// Audit energies of runs at several time steps, by any program: oscillation, drift, rounding, wrong forces
    Audit(AuditArgs),
    /// Check whether gains of servos hold at a time step, and with which integrator
    Gains(GainsArgs),
    /// Identify dead time, lag, gain and noise of a loop from a log of its commands and responses
    Identify(IdentifyArgs),
    /// Simulate one or many trajectories and write them as rows
    Simulate(SimulateArgs),
    /// Simulate bodies under their gravity and audit what they conserve
    Bodies(BodiesArgs),
    /// Write a data set of rollouts, or resume an interrupted one
    Rollout(RolloutArgs),
    /// Join the shards of a data set
    Join(JoinArgs),
    /// Check the files of a data set, recompute it or repair it; recompute a report
    Verify(VerifyArgs),
    /// Compare the findings of two runs of `lab`: what became worse, better, or differs
    Compare(CompareArgs),
    /// Show a system in the browser: drag its step, gains and latency, and see what they do
    Serve(ServeArgs),
    /// Measure the speed of simulations on this machine, and its hardware limits
    Bench(BenchArgs),
    /// Analyze the clocks of a log: rate, jitter, drift, latency between topics, and what they do to a loop
    Clock(ClockArgs),
    /// Measure the jitter of a periodic loop on this machine
    MeasureJitter(MeasureJitterArgs),
    /// List studies, systems and integrators
    List(ListArgs),
    /// Print the completion script of a shell
    Completions(CompletionsArgs),
}

/// Arguments of `list`.
#[derive(Args, Debug)]
#[command(after_help = LIST_EXAMPLES)]
pub(crate) struct ListArgs {
    /// File of equations to summarise [default: list studies, systems and integrators]
    #[arg(value_name = "FILE", value_parser = equation_file)]
    pub(crate) file: Option<PathBuf>,
    /// List the example files of equations, or print the file of one
    #[arg(
        long,
        value_name = "NAME",
        num_args = 0..=1,
        default_missing_value = "",
        conflicts_with = "file",
        value_parser = example,
        hide_possible_values = true
    )]
    pub(crate) examples: Option<String>,
    /// List the presets of latencies, with their sources
    #[arg(long, conflicts_with_all = ["file", "examples"])]
    pub(crate) presets: bool,
    /// Print the result as JSON
    #[arg(long)]
    pub(crate) json: bool,
}

const LIST_EXAMPLES: &str = "\
Examples:
  libration list
  libration list --examples
  libration list --examples cart-pole > mine.toml
  libration list mine.toml
  libration list --presets";

/// Parses the name of an example; none stands for all.
fn example(name: &str) -> Result<String, String> {
    let names = EquationExample::ALL.map(|example| example.name);
    if name.is_empty() || names.contains(&name) {
        return Ok(name.to_owned());
    }
    Err(format!("unknown example; expected one of {}", names.join(", ")))
}

/// Parses the path of a file of equations.
fn equation_file(path: &str) -> Result<PathBuf, String> {
    match system::is_file(path) {
        true => Ok(path.into()),
        false => Err("expected a file of equations, NAME.toml".to_owned()),
    }
}

/// Arguments of `completions`.
#[derive(Args, Debug)]
#[command(
    after_help = "Example:\n  libration completions bash > ~/.local/share/bash-completion/completions/libration"
)]
pub(crate) struct CompletionsArgs {
    /// Name of the shell
    pub(crate) shell: clap_complete::Shell,
}

/// Parses the arguments of this process. Help and version are failures with exit code 0.
pub(crate) fn parse() -> Result<Arguments, Failure> {
    let args: Vec<OsString> = std::env::args_os().collect();
    let command = Arguments::command().color(color_choice(&args));
    let matches = command.try_get_matches_from(args)?;
    Ok(Arguments::from_arg_matches(&matches)?)
}

impl AdviseArgs {
    /// Parses the words of a command line of `advise`.
    pub(crate) fn parse_words(words: Vec<String>) -> Result<Self, Failure> {
        match Arguments::try_parse_from(words)?.command {
            Command::Advise(args) => Ok(args),
            _ => Err(Failure::usage("the command is not advise")),
        }
    }
}

/// Returns the value of `--color`, even if the rest of the command line is wrong.
fn color_choice(words: &[OsString]) -> ColorChoice {
    let words: Vec<_> = words.iter().map(|word| word.to_string_lossy()).collect();
    let next = words.iter().skip(1).map(AsRef::as_ref).chain([""]);
    let choices =
        words.iter().zip(next).filter_map(|(word, next)| match word.strip_prefix("--color") {
            Some("") => next.parse().ok(),
            Some(value) => value.strip_prefix('=')?.parse().ok(),
            None => None,
        });
    choices.last().unwrap_or_default()
}

fn efforts() -> impl TypedValueParser<Value = Effort> {
    PossibleValuesParser::new(Effort::ALL.map(Effort::name))
        .try_map(|name| Effort::from_name(&name).ok_or("unknown effort"))
}
