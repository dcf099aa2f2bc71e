//! Division of work into time slices, with checks for interrupts in between.

use std::ops::Range;
use std::time::{Duration, Instant};

use pyo3::prelude::*;

/// Target duration of a slice.
const PIECE: Duration = Duration::from_millis(50);

/// By how much a piece may be longer than the one before it: what came first may have been faster than the rest.
const GROWTH: u64 = 16;

/// Runs items 0 to `all` in slices: first `first` items, then as many as take [`PIECE`].
///
/// # Errors
/// Errors of the work, and exceptions of signal handlers after a slice. Both end the work.
pub(crate) fn run_in_slices(
    py: Python<'_>,
    all: u64,
    first: u64,
    mut work: impl FnMut(Range<u64>) -> PyResult<()>,
) -> PyResult<()> {
    let (mut done, mut piece) = (0, first.max(1));
    while done < all {
        let end = all.min(done.saturating_add(piece));
        let start = Instant::now();
        work(done..end)?;
        let pieces = PIECE.as_secs_f64() / start.elapsed().as_secs_f64().max(1e-9);
        let fit = ((end - done) as f64 * pieces) as u64;
        (done, piece) = (end, fit.clamp(1, piece.saturating_mul(GROWTH)));
        py.check_signals()?;
    }
    Ok(())
}
