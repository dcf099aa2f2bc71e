//! The command line as types: what can be asked, and in which words.

mod advise;
mod analyze;
mod bench;
mod measure_jitter;
mod number;
mod rollout;
pub(crate) mod simd;
mod simulate;
mod system;
mod timing;

use std::ffi::OsString;
use std::path::PathBuf;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, ColorChoice, CommandFactory, FromArgMatches, Parser, Subcommand};
use libration::ensemble::InstructionSet;
use libration_lab::STUDIES;
use libration_study::Effort;

use crate::error::Failure;

pub(crate) use advise::AdviseArgs;
pub(crate) use analyze::AnalyzeArgs;
pub(crate) use bench::BenchArgs;
pub(crate) use measure_jitter::MeasureJitterArgs;
pub(crate) use rollout::{RolloutArgs, VerifyArgs};
pub(crate) use simulate::SimulateArgs;
pub(crate) use system::{StepArgs, SystemArgs};
pub(crate) use timing::CostArgs;

/// A laboratory for the stability of simulations: what theory predicts beside what was measured.
#[derive(Debug, Parser)]
#[command(name = "libration", version, propagate_version = true, max_term_width = 100)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// No progress and no summary; only what fails is told
    #[arg(long, short, global = true)]
    pub(crate) quiet: bool,
    /// When to use colour; `auto` looks at the terminal and at NO_COLOR
    #[arg(long, global = true, value_name = "WHEN", default_value = "auto")]
    pub(crate) color: ColorChoice,
    #[command(subcommand)]
    pub(crate) command: Command,
}

const EXAMPLES: &str = "\
Examples:
  libration lab                              every study, at the setting of the report
  libration lab drift --effort quick --open  one study, in seconds, shown in the browser
  libration lab --print-config > mine.toml   the setting, ready to edit
  libration lab --config mine.toml           the studies at your own setting
  libration simulate --system oscillator --integrator rk4 --dt 0.01 --steps 1000
                                             a trajectory as CSV
  libration analyze --system oscillator --integrator rk4 --dt 0.01
                                             what theory says of one step
  libration advise --system oscillator --feedback 10,2 --period 0.01 --latency 0.02
                                             what a loop can afford
  libration rollout --out data --transitions 1e8
                                             a data set of rollouts, as Parquet
  libration bench                            what this machine can do
  libration measure-jitter --rate 500        how punctual it is
  libration list                             what there is

Exit codes: 0 success, 1 a failed run or a finding that disagrees, 2 wrong input, 130 interrupted";

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Run studies and write a report
    Lab(LabArgs),
    /// Say what theory makes of one step of an integrator on a system
    Analyze(AnalyzeArgs),
    /// Say what can be afforded: integrator, step, float type, latency, jitter, skew and losses
    Advise(AdviseArgs),
    /// Simulate one trajectory and write its rows
    Simulate(SimulateArgs),
    /// Write a data set of rollouts, larger than memory, and go on where it was interrupted
    Rollout(RolloutArgs),
    /// Read a data set again, or compute it again, and compare
    Verify(VerifyArgs),
    /// Time this machine: how fast trajectories advance, and what limits them
    Bench(BenchArgs),
    /// Measure how punctual this machine is: when a real loop wakes up
    MeasureJitter(MeasureJitterArgs),
    /// List studies, systems and integrators
    List(ListArgs),
    /// Print a completion script for a shell
    Completions(CompletionsArgs),
}

/// What `lab` takes.
#[derive(Args, Debug)]
#[command(after_help = LAB_EXAMPLES)]
pub(crate) struct LabArgs {
    /// Studies to run [default: those of the configuration, or all]
    #[arg(value_name = "STUDY", value_parser = study_names())]
    pub(crate) studies: Vec<String>,
    /// Configuration file [default: the setting of the report]
    #[arg(long, value_name = "FILE")]
    pub(crate) config: Option<PathBuf>,
    /// Folder for the report
    #[arg(long, value_name = "DIR", default_value = "libration-report")]
    pub(crate) out: PathBuf,
    /// How much work the run may take [default: that of the configuration, or standard]
    #[arg(long, value_parser = efforts())]
    pub(crate) effort: Option<Effort>,
    /// Instruction set of what is timed [default: that of the configuration, or LIBRATION_SIMD]
    #[arg(long, value_name = "SET", value_parser = simd::instruction_sets())]
    pub(crate) simd: Option<InstructionSet>,
    /// Show the report in the browser when it is ready
    #[arg(long)]
    pub(crate) open: bool,
    /// Print the default configuration, with comments, and stop
    #[arg(long, conflicts_with_all = ["schema", "config", "studies", "effort", "simd", "open"])]
    pub(crate) print_config: bool,
    /// Print a JSON schema of the configuration, for editors, and stop
    #[arg(long, conflicts_with_all = ["config", "studies", "effort", "simd", "open"])]
    pub(crate) schema: bool,
}

const LAB_EXAMPLES: &str = "\
Examples:
  libration lab
  libration lab spectrum drift --out my-report
  libration lab --config mine.toml --effort thorough

The folder gets report.html, results.json, figures/*.svg and data/*.parquet when all studies have ended; they
replace those of an earlier run. Until then they are in its folder libration-unfinished, and stay there if an
interrupted run would replace a complete report.";

/// What `list` takes.
#[derive(Args, Debug)]
pub(crate) struct ListArgs {
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

/// What `completions` takes.
#[derive(Args, Debug)]
#[command(
    after_help = "Example:\n  libration completions bash > ~/.local/share/bash-completion/completions/libration"
)]
pub(crate) struct CompletionsArgs {
    /// The shell
    pub(crate) shell: clap_complete::Shell,
}

/// The arguments of this process. Help and version end up here as failures with exit code 0.
pub(crate) fn parse() -> Result<Arguments, Failure> {
    let words: Vec<OsString> = std::env::args_os().collect();
    let command = Arguments::command().color(asked_color(&words));
    let matches = command.try_get_matches_from(words)?;
    Ok(Arguments::from_arg_matches(&matches)?)
}

/// The colour that is asked for, even if the rest of the command line is wrong.
fn asked_color(words: &[OsString]) -> ColorChoice {
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

fn study_names() -> PossibleValuesParser {
    let value = |study: &&dyn libration_study::Study| {
        PossibleValue::new(study.name()).help(study.question())
    };
    PossibleValuesParser::new(STUDIES.studies.iter().map(value).collect::<Vec<_>>())
}

fn efforts() -> impl TypedValueParser<Value = Effort> {
    PossibleValuesParser::new(Effort::ALL.map(Effort::name))
        .try_map(|name| Effort::from_name(&name).ok_or("unknown effort"))
}
