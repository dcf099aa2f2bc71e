//! The output of a step of a block.

use libration_core::Float;

use super::EpisodeEnd;
use super::block_size::LANES;

/// The numbers of a step of a block, before they are written. It begins with a line of the cache, as each of its rows does: no
/// vector lies across two.
#[derive(Clone, Copy)]
pub(super) struct Step<T, const O: usize, const D: usize> {
    pub(super) seen: [[T; LANES]; O],
    pub(super) actions: [[T; LANES]; D],
    pub(super) log_probabilities: [T; LANES],
    pub(super) rewards: [T; LANES],
}

impl<T: Float, const O: usize, const D: usize> Step<T, O, D> {
    #[inline(always)]
    pub(super) fn zeros() -> Self {
        let zeros = [T::zero(); LANES];
        Step { seen: [zeros; O], actions: [zeros; D], log_probabilities: zeros, rewards: zeros }
    }
}

/// The output of a block.
#[repr(C, align(64))]
pub(super) struct BlockOutput<T, const O: usize, const D: usize> {
    /// The output of a step that is not fused.
    pub(super) step: Step<T, O, D>,
    pub(super) overs: [u8; LANES],
    pub(super) cuts: [u8; LANES],
    /// The ends of episodes so far.
    pub(super) finals: Vec<EpisodeEnd<T, O>>,
}

impl<T: Float, const O: usize, const D: usize> BlockOutput<T, O, D> {
    pub(super) fn zeros() -> Self {
        BlockOutput { step: Step::zeros(), overs: [0; LANES], cuts: [0; LANES], finals: Vec::new() }
    }
}
