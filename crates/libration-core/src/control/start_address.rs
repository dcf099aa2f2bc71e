//! The address of the random numbers of a start.

use crate::control::Jitter;
use crate::random::{Address, Purpose};

/// The address of all random numbers that a trajectory or episode draws once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StartAddress {
    seed: u64,
    trajectory: u64,
    step: u64,
    /// Of the parts of a pair: 0 is the whole, and `2p + 1` and `2p + 2` are the halves of `p`.
    part: u64,
}

/// The number of distinct parts: pairs of pairs, six levels deep.
const PARTS: u64 = 128;

impl StartAddress {
    /// The start of `trajectory` in the run of `seed`. `step` is 0 or that of its reset; for an environment, the number of its episode.
    pub fn new(seed: u64, trajectory: u64, step: u64) -> Self {
        StartAddress { seed, trajectory, step, part: 0 }
    }

    /// The number of the trajectory.
    pub fn trajectory(self) -> u64 {
        self.trajectory
    }

    /// The addresses of the halves of a pair, whose draws are independent.
    pub fn halves(self) -> [StartAddress; 2] {
        [1, 2].map(|half| StartAddress { part: (2 * self.part + half) % PARTS, ..self })
    }

    /// The address of a draw for a purpose.
    pub fn address(self, purpose: Purpose) -> Address {
        let StartAddress { seed, trajectory, step, part } = self;
        Address { seed, trajectory, step: step.wrapping_mul(PARTS).wrapping_add(part), purpose }
    }

    /// A draw from a distribution.
    pub fn draw(self, law: Jitter, purpose: Purpose) -> f64 {
        if law.rms() == 0.0 {
            return 0.0;
        }
        let place = self.address(purpose);
        match law {
            Jitter::Gaussian(rms) => rms * place.gaussian()[0],
            // The width of a uniform law is √12 of its deviations.
            Jitter::Uniform(rms) => rms * 12.0_f64.sqrt() * (place.uniform()[0] - 0.5),
        }
    }
}
