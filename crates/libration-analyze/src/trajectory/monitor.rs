//! Monitors of running simulations.

use std::sync::atomic::{AtomicBool, Ordering};

/// Receives the progress of a simulation and can stop it. A flag is a monitor that stops the simulation once it is set.
pub trait Monitor: Sync {
    /// Called after `step` steps.
    fn on_step(&self, step: u64) {
        let _ = step;
    }

    /// Whether the simulation should stop.
    fn should_stop(&self) -> bool {
        false
    }
}

impl Monitor for AtomicBool {
    fn should_stop(&self) -> bool {
        self.load(Ordering::Relaxed)
    }
}
