//! Streams of random words for neighbouring trajectories.

use super::{Address, Purpose};

/// The number of steps per draw by address.
///
/// A draw costs as much as a hundred operations, a word that follows from the one before costs seven.
pub const EPOCH: u64 = 256;

/// A generator for each of `W` neighbouring trajectories. Its words in a step depend only on the seed, the
/// trajectory, the step and the purpose.
///
/// Every [`EPOCH`] steps its state is drawn by address; in between it is xoroshiro64*: D. Blackman, S. Vigna,
/// *Scrambled linear pseudorandom number generators*, ACM Transactions on Mathematical Software 47, 2021,
/// table 3.
#[derive(Clone, Copy, Debug)]
pub struct Streams<const W: usize> {
    low: [u32; W],
    high: [u32; W],
}

impl<const W: usize> Streams<W> {
    /// The generators of the trajectories from `first` on, at the beginning of an epoch.
    #[inline(always)]
    pub fn at(seed: u64, first: u64, epoch: u64, purpose: Purpose) -> Self {
        let mut streams = Streams { low: [0; W], high: [0; W] };
        for l in 0..W {
            let trajectory = first + l as u64;
            streams.begin_epoch(l, Address { seed, trajectory, step: epoch, purpose });
        }
        streams
    }

    /// Begins an epoch of generator `l` at the address `epoch`.
    #[inline(always)]
    pub fn begin_epoch(&mut self, l: usize, epoch: Address) {
        let [low, high, ..] = epoch.bits();
        // A state of zeros would stay one.
        (self.low[l], self.high[l]) = (low, high | 1);
    }

    /// Copies generator `l` of `from`.
    #[inline(always)]
    pub fn copy_lane(&mut self, l: usize, from: &Self) {
        (self.low[l], self.high[l]) = (from.low[l], from.high[l]);
    }

    /// Unused generators.
    pub fn none() -> Self {
        Streams { low: [0; W], high: [0; W] }
    }

    /// The generators of the trajectories from `first` on, at `step`, if each step takes `words` words. They are
    /// unused if `words` is 0.
    #[inline(always)]
    pub fn at_step(seed: u64, first: u64, step: u64, purpose: Purpose, words: usize) -> Self {
        if words == 0 {
            return Streams::none();
        }
        let mut streams = Streams::at(seed, first, step / EPOCH, purpose);
        for _ in 0..(step % EPOCH) as usize * words {
            for l in 0..W {
                streams.next(l);
            }
        }
        streams
    }

    /// The next word of generator `l`.
    #[inline(always)]
    pub fn next(&mut self, l: usize) -> u32 {
        let (low, high) = (self.low[l], self.high[l] ^ self.low[l]);
        self.low[l] = low.rotate_left(26) ^ high ^ (high << 9);
        self.high[l] = high.rotate_left(13);
        low.wrapping_mul(0x9E37_79BB)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_those_of_the_published_generator() {
        // From the state (1, 2), by the reference implementation in C of its authors.
        let mut streams = Streams { low: [1], high: [2] };
        let words: [u32; 10] = core::array::from_fn(|_| streams.next(0));
        assert_eq!(
            words,
            [
                2_654_435_771,
                327_208_753,
                4_063_491_769,
                4_259_754_937,
                261_922_412,
                168_123_673,
                552_743_735,
                1_672_597_395,
                1_031_040_050,
                2_755_315_674,
            ]
        );
    }

    #[test]
    fn a_lane_does_not_depend_on_its_neighbours() {
        let mut wide = Streams::<16>::at(5, 32, 3, Purpose::StepTime);
        let mut lone = Streams::<1>::at(5, 39, 3, Purpose::StepTime);
        for _ in 0..EPOCH {
            let words: Vec<u32> = (0..16).map(|l| wide.next(l)).collect();
            assert_eq!(words[7], lone.next(0));
        }
    }
}
