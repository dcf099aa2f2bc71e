//! Random words on their way.

use super::kernel::LANES;
use crate::random::{Purpose, Streams};

/// The words of all blocks for one purpose, as they are before some step.
#[derive(Clone, Debug)]
pub(super) struct Draws {
    purpose: Purpose,
    /// The number of the first environment.
    first: usize,
    streams: Vec<Streams<LANES>>,
    /// The step, and how many words each takes.
    ready: Option<(u64, usize)>,
}

impl Draws {
    pub(super) fn new(purpose: Purpose, first: usize) -> Self {
        Draws { purpose, first, streams: Vec::new(), ready: None }
    }

    /// Makes them those before `step`, where each step takes so many words; a step of none has no streams. What follows takes
    /// `steps` of them.
    pub(super) fn prepare(
        &mut self,
        seed: u64,
        step: u64,
        steps: u64,
        words: usize,
        blocks: usize,
    ) -> &mut [Streams<LANES>] {
        if words == 0 {
            self.ready = None;
            return &mut [];
        }
        if self.ready != Some((step, words)) || self.streams.len() != blocks {
            let first = |b: usize| (self.first + b * LANES) as u64;
            let at = |b: usize| Streams::resumed(seed, first(b), step, self.purpose, words);
            self.streams = (0..blocks).map(at).collect();
        }
        self.ready = Some((step + steps, words));
        &mut self.streams
    }
}
