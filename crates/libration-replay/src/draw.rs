//! The address of a batch.

use libration_core::random::{Address, Purpose};

/// The address of a batch: the same one draws the same from the same transitions, whatever was drawn before.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Draw {
    /// The seed of the run.
    pub seed: u64,
    /// The number of the batch, different for each batch.
    pub number: u64,
}

impl Draw {
    /// Random words of entry `i` of the batch, upon the `attempt`-th attempt.
    fn bits(self, i: usize, attempt: u32) -> [u64; 2] {
        let trajectory = i as u64 & 0xffff_ffff | u64::from(attempt) << 32;
        let Draw { seed, number: step } = self;
        let address = Address { seed, trajectory, step, purpose: Purpose::Replay };
        let [a, b, c, d] = address.bits();
        [u64::from(b) << 32 | u64::from(a), u64::from(d) << 32 | u64::from(c)]
    }

    /// Two numbers below `count`, each as likely: but for one part in 2⁶⁴ of `count`.
    pub(super) fn below(self, i: usize, attempt: u32, count: u64) -> [u64; 2] {
        self.bits(i, attempt).map(|word| ((u128::from(word) * u128::from(count)) >> 64) as u64)
    }

    /// A number from 0 up to below 1.
    pub(super) fn share(self, i: usize) -> f64 {
        (self.bits(i, 0)[0] >> 11) as f64 / (1_u64 << 53) as f64
    }
}
