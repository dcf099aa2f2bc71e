//! The `libration` command: arguments in, exit codes out.

mod args;
mod commands;
mod error;
mod interrupt;
mod output_file;
mod progress;
mod terminal;

use std::panic;
use std::process::ExitCode;
use std::thread::Builder;

use error::Failure;

/// Bytes of the stack. It is taken as a whole: that of the main thread grows, and dies where it may not (`ulimit -v`).
const STACK: usize = 8 << 20;

fn main() -> ExitCode {
    interrupt::outlive_full_files();
    interrupt::fail_where_memory_ends();
    panic::set_hook(Box::new(|panic| terminal::error(&format!("this is a bug: {panic}"))));
    match Builder::new().stack_size(STACK).spawn(run) {
        // A panic has been told of.
        Ok(running) => running.join().unwrap_or(ExitCode::from(error::FAILED)),
        Err(error) => Failure::run(format!("cannot start a thread: {error}")).report(),
    }
}

fn run() -> ExitCode {
    match interrupt::handle().and_then(|()| args::parse()).and_then(commands::run) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}
