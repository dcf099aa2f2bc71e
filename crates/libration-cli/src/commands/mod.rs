//! One module for each subcommand.

mod adaptive_steps;
mod advice_output;
mod advise;
mod advise_linear;
mod analyze;
mod analyze_linear;
mod audit;
mod audit_text;
mod bench;
mod bodies;
mod clock;
mod clock_effect;
mod clock_page;
mod clock_report;
mod clock_text;
mod closed_loop;
mod compare;
mod compare_integrators;
mod completions;
mod config_file;
mod dataset_progress;
mod digits;
mod disagreements;
mod equation_file;
mod equation_loop;
mod finding;
mod gains;
mod identify;
mod identify_text;
mod lab;
mod linear_closed_loop;
mod list;
mod log_warnings;
mod measure_jitter;
mod mode_text;
mod motion_text;
mod mujoco;
mod page_server;
mod presets;
mod probe;
mod probe_text;
mod repeat_command;
mod result_file;
mod rollout;
mod serve;
mod simulate;
mod step_matrix;
mod summary;
mod temperature;
mod time_stamps;
mod verify_report;
mod watched;

use crate::args::{Arguments, Command};
use crate::error::Failure;
use crate::terminal;

/// Runs the command.
pub(crate) fn run(arguments: Arguments) -> Result<(), Failure> {
    terminal::set_color(arguments.color);
    match arguments.command {
        Command::Lab(args) => lab::run(&args, arguments.quiet),
        Command::Advise(args) => advise::run(&args, arguments.quiet),
        Command::Analyze(args) => analyze::run(&args),
        Command::Simulate(args) => simulate::run(&args, arguments.quiet),
        Command::Compare(args) => compare::run(&args),
        Command::Serve(args) => serve::run(&args),
        Command::Bodies(args) => bodies::run(&args, arguments.quiet),
        Command::Rollout(args) => rollout::run(&args, arguments.quiet),
        Command::Join(args) => rollout::join(&args, arguments.quiet),
        Command::Verify(args) => rollout::verify(&args, arguments.quiet),
        Command::Bench(args) => bench::run(&args, arguments.quiet),
        Command::Gains(args) => gains::run(&args),
        Command::Identify(args) => identify::run(&args, arguments.quiet),
        Command::Audit(args) => audit::run(&args),
        Command::Probe(args) => probe::run(&args, arguments.quiet),
        Command::Clock(args) => clock::run(&args, arguments.quiet),
        Command::MeasureJitter(args) => measure_jitter::run(&args, arguments.quiet),
        Command::List(args) => list::run(&args),
        Command::Completions(args) => completions::run(&args),
    }
}
