//! What blocks yield.

use super::Final;
use super::kernel::LANES;
use crate::Float;

/// What a block yields in a step, before it is written. It begins with a line of the cache, as each of its rows does: no vector
/// lies across two.
#[repr(C, align(64))]
pub(super) struct Yield<T, const O: usize, const D: usize> {
    pub(super) seen: [[T; LANES]; O],
    pub(super) actions: [[T; LANES]; D],
    pub(super) log_probabilities: [T; LANES],
    pub(super) rewards: [T; LANES],
    pub(super) overs: [u8; LANES],
    pub(super) cuts: [u8; LANES],
    /// The episodes that ended so far.
    pub(super) finals: Vec<Final<T, O>>,
}

impl<T: Float, const O: usize, const D: usize> Yield<T, O, D> {
    pub(super) fn zeros() -> Self {
        let zeros = [T::zero(); LANES];
        Yield {
            seen: [zeros; O],
            actions: [zeros; D],
            log_probabilities: zeros,
            rewards: zeros,
            overs: [0; LANES],
            cuts: [0; LANES],
            finals: Vec::new(),
        }
    }
}
