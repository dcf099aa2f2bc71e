//! Streams of random words per episode.
//!
//! The draws of a step depend on the episode and on its number of steps before. They do not depend on the reset mode or on the
//! episodes of other environments of the block.

use libration_core::Scalar;
use libration_core::random::{EPOCH, Purpose, Streams};

use super::block::Block;
use super::block_size::LANES;

/// The words of all blocks for one purpose, as they are before some step.
#[derive(Clone, Debug)]
pub(super) struct EpisodeStreams {
    purpose: Purpose,
    streams: Vec<Streams<LANES>>,
    /// The step, and how many words each takes.
    ready: Option<(u64, usize)>,
}

impl EpisodeStreams {
    pub(super) fn new(purpose: Purpose) -> Self {
        EpisodeStreams { purpose, streams: Vec::new(), ready: None }
    }

    /// Other episodes have taken the place of those that were.
    pub(super) fn invalidate(&mut self) {
        self.ready = None;
    }

    /// Makes them those before `step`, of which each has so many parts that each take so many words; where they take none there are no
    /// streams. What follows takes `steps` steps.
    pub(super) fn prepare<T: Scalar, C: Copy, V, const D: usize>(
        &mut self,
        blocks: &[Block<T, C, V, D>],
        [step, parts]: [u64; 2],
        steps: u64,
        words: usize,
    ) -> &mut [Streams<LANES>] {
        if words == 0 {
            self.ready = None;
            return &mut [];
        }
        if self.ready != Some((step, words)) || self.streams.len() != blocks.len() {
            let at = |block| streams_at(block, [step, parts, 0], self.purpose, words);
            self.streams = blocks.iter().map(at).collect();
        }
        self.ready = Some((step + steps, words));
        &mut self.streams
    }
}

/// The words of a block as they are before part `part` of step `now`, where each of its `parts` took so many.
fn streams_at<T: Scalar, C: Copy, V, const D: usize>(
    block: &Block<T, C, V, D>,
    [now, parts, part]: [u64; 3],
    purpose: Purpose,
    words: usize,
) -> Streams<LANES> {
    let mut streams = Streams::none();
    for l in 0..LANES {
        let age = (now - block.began[l]).wrapping_mul(parts).wrapping_add(part);
        streams.begin_epoch(l, block.episode(l).epoch(purpose, age / EPOCH));
        for _ in 0..(age % EPOCH) as usize * words {
            streams.next(l);
        }
    }
    streams
}

/// Before part `part` of step `now`, of which each has so many: whose episode enters an epoch draws by address.
#[inline(always)]
pub(super) fn begin_epochs<T: Scalar, C: Copy, V, const D: usize>(
    streams: &mut Streams<LANES>,
    block: &Block<T, C, V, D>,
    [now, parts, part]: [u64; 3],
    purpose: Purpose,
) {
    // The lowest bits of all ages say whether anything is to be done, which is rare.
    let mut due = false;
    for began in &block.began {
        let age = (now as u32).wrapping_sub(*began as u32).wrapping_mul(parts as u32);
        due |= age.wrapping_add(part as u32).is_multiple_of(EPOCH as u32);
    }
    if due {
        begin_due_epochs(streams, block, [now, parts, part], purpose);
    }
}

#[cold]
#[inline(never)]
fn begin_due_epochs<T: Scalar, C: Copy, V, const D: usize>(
    streams: &mut Streams<LANES>,
    block: &Block<T, C, V, D>,
    [now, parts, part]: [u64; 3],
    purpose: Purpose,
) {
    for l in 0..LANES {
        let age = (now - block.began[l]).wrapping_mul(parts).wrapping_add(part);
        if age.is_multiple_of(EPOCH) {
            streams.begin_epoch(l, block.episode(l).epoch(purpose, age / EPOCH));
        }
    }
}
