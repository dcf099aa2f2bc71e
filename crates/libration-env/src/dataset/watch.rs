//! How far a data set is, and whether to stop.

use libration_data::Flaw;

/// Who watches a data set being written or read.
pub trait Watch: Sync {
    /// So many more transitions, in so many bytes, are done.
    fn done(&self, transitions: u64, bytes: u64);

    /// So many were there before.
    fn there(&self, transitions: u64, bytes: u64) {
        self.done(transitions, bytes);
    }

    /// The checksums of so many bytes have been compared, of as many as there are.
    fn checked(&self, bytes: u64, of: u64) {
        let _ = (bytes, of);
    }

    /// A broken file has been computed again and replaced.
    fn repaired(&self, flaw: &Flaw) {
        let _ = flaw;
    }

    /// Whether to stop.
    fn stops(&self) -> bool {
        false
    }
}
