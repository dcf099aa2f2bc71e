//! The `libration` command: arguments in, exit codes out.

mod args;
mod commands;
mod error;
mod interrupt;
mod output_file;
mod progress;
mod terminal;

use std::io::Write;
use std::panic::{self, PanicHookInfo};
use std::process::{self, ExitCode};
use std::thread::Builder;

use error::Failure;

/// Bytes of the stack. It is taken as a whole: that of the main thread grows, and dies where it may not (`ulimit -v`).
const STACK: usize = 8 << 20;

fn main() -> ExitCode {
    interrupt::outlive_full_files();
    interrupt::fail_where_memory_ends();
    panic::set_hook(Box::new(report_panic));
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

/// Reports a panic as the bug that it is. The standard library panics, too, where the system has no memory for a thread's stacks:
/// that ends the run, with a message for which no memory is needed.
fn report_panic(panic: &PanicHookInfo<'_>) {
    if !panic.payload_as_str().is_some_and(is_out_of_memory) {
        return terminal::error(&format!("this is a bug: {panic}"));
    }
    // If it cannot be written, nobody is left to tell.
    let _ = std::io::stderr().write_all(OUT_OF_MEMORY);
    process::exit(i32::from(error::FAILED));
}

/// What is said where there is no memory to say more.
const OUT_OF_MEMORY: &[u8] =
    b"error: out of memory: the system has none for a thread; help: lower --threads, or raise the limit (ulimit -v)\n";

/// Whether a panic of the standard library says that a thread could not be made, or has the operating system's error number 12,
/// `ENOMEM`, in one of the two ways in which Rust prints it.
fn is_out_of_memory(message: &str) -> bool {
    let parts = ["failed to spawn thread", "(os error 12)", "code: 12,"];
    parts.iter().any(|part| message.contains(part))
}

#[cfg(test)]
mod tests {
    use std::io;

    use super::*;

    #[test]
    fn a_panic_for_want_of_memory_is_told_from_a_bug() {
        let refused = io::Error::from_raw_os_error(12);
        assert!(is_out_of_memory(&format!("failed to allocate an alternative stack: {refused}")));
        assert!(is_out_of_memory(&format!("failed to spawn thread: {refused:?}")));
        let missing = io::Error::from_raw_os_error(2);
        assert!(!is_out_of_memory(&format!("{missing} {missing:?}")));
        assert!(!is_out_of_memory("index out of bounds: the len is 12"));
    }
}
