//! Monitors of data sets.

use libration_data::Flaw;

/// Receives the progress of a data set and can stop the work.
pub trait Monitor: Sync {
    /// Called when transitions were written or recomputed.
    fn on_written(&self, transitions: u64, bytes: u64);

    /// Called when transitions are already present.
    fn on_present(&self, transitions: u64, bytes: u64) {
        self.on_written(transitions, bytes);
    }

    /// Called when a chunk that is on the disk was computed again, because there was no state to continue from.
    fn on_recomputed(&self) {}

    /// Called when `bytes` bytes of `of` were verified.
    fn on_verified(&self, bytes: u64, of: u64) {
        let _ = (bytes, of);
    }

    /// Called when a broken file was replaced.
    fn on_repaired(&self, flaw: &Flaw) {
        let _ = flaw;
    }

    /// Whether the work should stop.
    fn should_stop(&self) -> bool {
        false
    }
}
