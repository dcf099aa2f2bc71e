//! Signals. Ctrl-C: the first asks the run to stop, the second stops it at once.

use std::process;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::error::{FAILED, Failure, INTERRUPTED};

static STOP: AtomicBool = AtomicBool::new(false);
/// Whether something looks at [`STOP`].
static LISTENING: AtomicBool = AtomicBool::new(false);

/// From now on, Ctrl-C ends the process with the exit code of an interrupted run.
///
/// # Errors
/// If the operating system refuses the handler.
pub(crate) fn handle() -> Result<(), Failure> {
    ctrlc::set_handler(|| {
        if !LISTENING.load(Ordering::Relaxed) || STOP.swap(true, Ordering::Relaxed) {
            process::exit(i32::from(INTERRUPTED));
        }
    })
    .map_err(|error| Failure::run(format!("cannot listen for Ctrl-C: {error}")))
}

/// From now on, the first Ctrl-C sets the flag.
pub(crate) fn listen() -> &'static AtomicBool {
    LISTENING.store(true, Ordering::Relaxed);
    &STOP
}

/// An allocation that the system refuses, of which Rust says how large it is before it aborts, ends the process with the exit code of a
/// failed run from now on.
pub(crate) fn fail_where_memory_ends() {
    #[cfg(unix)]
    {
        use signal_hook::{consts::SIGABRT, flag::register_conditional_shutdown};
        use std::sync::Arc;
        let always = Arc::new(AtomicBool::new(true));
        // Where the handler is refused, the process aborts as it always did.
        let _ = register_conditional_shutdown(SIGABRT, i32::from(FAILED), always);
    }
}

/// A file that may not grow is an error of writing to it from now on, and not the end of the process.
pub(crate) fn outlive_full_files() {
    #[cfg(unix)]
    {
        use std::sync::Arc;
        // Where the handler is refused, the system does what it always did.
        let flag = Arc::new(AtomicBool::new(false));
        let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, flag);
    }
}
