//! How far a simulation is, and whether to stop it.

use std::sync::atomic::{AtomicBool, Ordering};

/// Watches a simulation. A flag is one: the simulation stops soon after it is set.
pub trait Watch: Sync {
    /// The simulation has taken so many steps.
    fn reached(&self, step: u64) {
        let _ = step;
    }

    /// Whether to stop.
    fn stops(&self) -> bool {
        false
    }
}

impl Watch for AtomicBool {
    fn stops(&self) -> bool {
        self.load(Ordering::Relaxed)
    }
}
