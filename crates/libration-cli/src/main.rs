//! The `libration` command: arguments in, exit codes out.

mod args;
mod commands;
mod error;
mod interrupt;
mod output_file;
mod progress;
mod terminal;

use std::process::ExitCode;

fn main() -> ExitCode {
    interrupt::outlive_full_files();
    let outcome = match args::parse() {
        Ok(args) => commands::run(args),
        Err(failure) => Err(failure),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}
