//! Signals. The first Ctrl-C stops the run in order, the second at once.

use std::process;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use libration_probe::end_programs;

use crate::error::{FAILED, Failure, INTERRUPTED};
use crate::output_file::remove_temporary_files;
use crate::terminal;

static STOP: AtomicBool = AtomicBool::new(false);
/// Whether the run checks [`STOP`].
static LISTENING: AtomicBool = AtomicBool::new(false);

/// Whether the run computes and writes nothing, so that nothing is lost where it ends.
static COMPUTING: AtomicBool = AtomicBool::new(false);

/// The time in which a computation that checks [`STOP`] ends in order.
const GRACE: Duration = Duration::from_millis(500);

/// Installs the handler of Ctrl-C, which ends the process with the exit code of an interrupted run.
///
/// # Errors
/// If the operating system refuses the handler.
pub(crate) fn handle() -> Result<(), Failure> {
    ctrlc::set_handler(|| {
        if !LISTENING.load(Ordering::Relaxed) || STOP.swap(true, Ordering::Relaxed) {
            end_programs();
            process::exit(i32::from(INTERRUPTED));
        }
        end_computation();
    })
    .map_err(|error| Failure::run(format!("cannot listen for Ctrl-C: {error}")))
}

/// Returns a flag that the first Ctrl-C sets.
pub(crate) fn listen() -> &'static AtomicBool {
    LISTENING.store(true, Ordering::Relaxed);
    &STOP
}

/// Runs a computation that writes nothing, with the flag that the first Ctrl-C sets. A search that does not check the flag ends with the
/// process, a moment later.
pub(crate) fn compute<R>(work: impl FnOnce(&'static AtomicBool) -> R) -> R {
    let stop = listen();
    COMPUTING.store(true, Ordering::SeqCst);
    let result = work(stop);
    COMPUTING.store(false, Ordering::SeqCst);
    result
}

/// Ends the process unless its computation ends in order.
fn end_computation() {
    let watch = || {
        thread::sleep(GRACE);
        if COMPUTING.swap(false, Ordering::SeqCst) {
            remove_temporary_files();
            terminal::say("interrupted");
            process::exit(i32::from(exit_code()));
        }
    };
    if COMPUTING.load(Ordering::SeqCst) && thread::Builder::new().spawn(watch).is_err() {
        process::exit(i32::from(exit_code()));
    }
}

/// The exit code of a run that a termination stops.
pub(crate) const TERMINATED: u8 = 143;

static IS_TERMINATED: AtomicBool = AtomicBool::new(false);

/// The exit code of an interrupted run: by Ctrl-C, or by a termination.
pub(crate) fn exit_code() -> u8 {
    if IS_TERMINATED.load(Ordering::Relaxed) { TERMINATED } else { INTERRUPTED }
}

/// Lets a run that listens end in order when it is terminated, so that it keeps what it has, and any other program at once. Simulators
/// that this process starts end too: they are not in its group.
pub(crate) fn handle_termination() {
    #[cfg(unix)]
    {
        use signal_hook::{consts::SIGTERM, iterator::Signals, low_level::emulate_default_handler};
        // Without the handler the signal ends this process alone, and each simulator at the end of its input.
        let Ok(mut signals) = Signals::new([SIGTERM]) else { return };
        let _ = thread::Builder::new().spawn(move || {
            for signal in signals.forever() {
                end_programs();
                let is_again = IS_TERMINATED.swap(true, Ordering::Relaxed);
                if is_again || !LISTENING.load(Ordering::Relaxed) {
                    let _ = emulate_default_handler(signal);
                }
                STOP.store(true, Ordering::Relaxed);
                end_computation();
            }
        });
    }
}

/// Makes a failed allocation end the process with the exit code of a failed run. Rust prints the size before it aborts.
pub(crate) fn exit_on_failed_allocation() {
    #[cfg(unix)]
    {
        use signal_hook::{consts::SIGABRT, flag::register_conditional_shutdown};
        use std::sync::Arc;
        let always = Arc::new(AtomicBool::new(true));
        // Without the handler the process aborts, as by default.
        let _ = register_conditional_shutdown(SIGABRT, i32::from(FAILED), always);
    }
}

/// Makes a file at its size limit an error of the write, not the end of the process.
pub(crate) fn ignore_file_size_signal() {
    #[cfg(unix)]
    {
        use std::sync::Arc;
        // Without the handler the signal ends the process, as by default.
        let flag = Arc::new(AtomicBool::new(false));
        let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, flag);
    }
}
