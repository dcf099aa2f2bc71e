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
use libration_logs::PARQUET_THREAD;

/// Bytes of the stack. A thread reserves it as a whole; the stack of the main thread grows, and crashes at a limit (`ulimit -v`).
const STACK: usize = 8 << 20;

fn main() -> ExitCode {
    interrupt::ignore_file_size_signal();
    interrupt::exit_on_failed_allocation();
    interrupt::handle_termination();
    panic::set_hook(Box::new(report_panic));
    match Builder::new().stack_size(STACK).spawn(run) {
        // The hook has reported a panic.
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

/// Reports a panic as a bug. A panic for lack of memory (of the standard library, or of a compressor) ends the run instead, with a
/// message that needs no memory.
fn report_panic(panic: &PanicHookInfo<'_>) {
    if std::thread::current().name() == Some(PARQUET_THREAD) {
        // The reader of the file returns an error.
        return;
    }
    if !panic.payload_as_str().is_some_and(is_out_of_memory) {
        return terminal::error(&format!("this is a bug: {panic}"));
    }
    // A failed write to stderr has no other place for a message.
    let _ = std::io::stderr().write_all(OUT_OF_MEMORY);
    process::exit(i32::from(error::FAILED));
}

/// The message for lack of memory.
const OUT_OF_MEMORY: &[u8] =
    b"error: out of memory; help: lower --threads, or raise the limit (ulimit -v)\n";

/// Whether the message of a panic reports a failed thread, the operating system's error 12, `ENOMEM`, in either format of Rust, or
/// that Zstandard got no memory for a context.
fn is_out_of_memory(message: &str) -> bool {
    let parts =
        ["failed to spawn thread", "(os error 12)", "code: 12,", "zstd returned null pointer"];
    parts.iter().any(|part| message.contains(part))
}

#[cfg(test)]
mod tests {
    use std::io;

    use super::*;

    #[test]
    fn a_panic_for_lack_of_memory_is_no_bug() {
        let refused = io::Error::from_raw_os_error(12);
        assert!(is_out_of_memory(&format!("failed to allocate an alternative stack: {refused}")));
        assert!(is_out_of_memory(&format!("failed to spawn thread: {refused:?}")));
        // The words of `zstd_safe::DCtx::create`.
        assert!(is_out_of_memory("zstd returned null pointer when creating new context"));
        let missing = io::Error::from_raw_os_error(2);
        assert!(!is_out_of_memory(&format!("{missing} {missing:?}")));
        assert!(!is_out_of_memory("index out of bounds: the len is 12"));
    }
}
