//! Signals. Ctrl-C: the first asks the run to stop, the second stops it at once.

use std::process;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::error::{Failure, INTERRUPTED};

static STOP: AtomicBool = AtomicBool::new(false);

/// From now on, the flag is set on Ctrl-C.
///
/// # Errors
/// If the operating system refuses the handler.
pub(crate) fn listen() -> Result<&'static AtomicBool, Failure> {
    ctrlc::set_handler(|| {
        if STOP.swap(true, Ordering::Relaxed) {
            process::exit(i32::from(INTERRUPTED));
        }
    })
    .map_err(|error| Failure::run(format!("cannot listen for Ctrl-C: {error}")))?;
    Ok(&STOP)
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
