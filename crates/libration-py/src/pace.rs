//! How much is done before somebody who wants to interrupt is asked again.

use std::ops::Range;
use std::time::{Duration, Instant};

use pyo3::prelude::*;

/// How long a piece of work takes, as far as the last one tells.
const PIECE: Duration = Duration::from_millis(50);

/// By how much a piece may be longer than the one before it: what came first may have been faster than the rest.
const GROWTH: u64 = 16;

/// Does work number 0, 1, … up to `all`, piece by piece: `first` of them, and then as many as take [`PIECE`].
///
/// # Errors
/// What the work returned, and what a handler of signals raised after a piece; nothing follows either.
pub(crate) fn paced(
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
