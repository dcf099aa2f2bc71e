//! Addresses of random numbers.

use core::f64::consts::TAU;

use super::philox4x32;
use crate::Elementary;

/// The purpose of a random number. Draws for different purposes are independent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Purpose {
    /// The time of a step.
    StepTime,
    /// The rate of a clock.
    ClockRate,
    /// The drift of a clock.
    ClockDrift,
    /// The memory of a clock before its first step.
    ClockStart,
    /// The latency of a command.
    Latency,
    /// The latency before the first step.
    LatencyStart,
    /// The start of a trajectory.
    Start,
    /// The random parameters of an episode of an environment.
    Variation,
    /// The latencies of an episode.
    Delay,
    /// The noise of observations.
    Observation,
    /// An action.
    Action,
    /// A batch of a replay buffer.
    Replay,
    /// A disturbance of a plant.
    Disturbance,
    /// The noise of a thermostat.
    Thermostat,
}

/// The place of a draw.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Address {
    /// The seed of the run.
    pub seed: u64,
    /// Below 2⁵⁶.
    pub trajectory: u64,
    /// Counted from the start.
    pub step: u64,
    /// The purpose.
    pub purpose: Purpose,
}

impl Address {
    /// 128 random bits.
    #[inline(always)]
    pub fn bits(self) -> [u32; 4] {
        let halves = |x: u64| [x as u32, (x >> 32) as u32];
        let ([low, high], [near, far]) = (halves(self.step), halves(self.trajectory));
        // The highest byte of the trajectory's number is free.
        let purpose = (self.purpose as u32) << 24;
        philox4x32([low, high, near, far | purpose], halves(self.seed))
    }

    /// Two independent numbers, uniform on (0, 1): neither end is ever drawn.
    #[inline(always)]
    pub fn uniform(self) -> [f64; 2] {
        let [a, b, c, d] = self.bits();
        let number = |low: u32, high: u32| {
            let bits = (u64::from(high) << 32 | u64::from(low)) >> 12;
            // In the middle of one of 2⁵² intervals.
            (bits as f64 + 0.5) / (1_u64 << 52) as f64
        };
        [number(a, b), number(c, d)]
    }

    /// Two independent numbers with the standard normal distribution.
    ///
    /// G. E. P. Box, M. E. Muller, *A note on the generation of random normal deviates*, The Annals of Mathematical
    /// Statistics 29, 1958. The largest that can be drawn is 8.6.
    #[inline(always)]
    pub fn gaussian(self) -> [f64; 2] {
        let [u, turn] = self.uniform();
        let radius = (-2.0 * libm::log(u)).sqrt();
        let angle = TAU * turn;
        // The functions of this crate: the same bits on every machine.
        [radius * Elementary::cos(angle), radius * Elementary::sin(angle)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(step: u64) -> Address {
        Address { seed: 7, trajectory: 3, step, purpose: Purpose::StepTime }
    }

    /// The first four moments of `draw` over many steps.
    fn moments(draw: impl Fn(Address) -> [f64; 2]) -> [f64; 4] {
        const COUNT: u64 = 1 << 19;
        let mut sums = [0.0; 4];
        for x in (0..COUNT).flat_map(|step| draw(at(step))) {
            let mut power = 1.0;
            for sum in &mut sums {
                power *= x;
                *sum += power;
            }
        }
        sums.map(|sum| sum / (2 * COUNT) as f64)
    }

    /// Each mean of 2²⁰ draws is within four standard errors: √(variance of the power)/2¹⁰.
    fn assert_moments(found: [f64; 4], wanted: [f64; 4], deviations: [f64; 4]) {
        for ((found, wanted), deviation) in found.into_iter().zip(wanted).zip(deviations) {
            assert!((found - wanted).abs() < 4.0 * deviation / 1024.0, "{found} {wanted}");
        }
    }

    #[test]
    fn draws_have_the_moments_of_their_laws() {
        let centred = |address: Address| address.uniform().map(|x| 2.0 * x - 1.0);
        // E[x²ᵏ] = 1/(2k + 1) on (−1, 1).
        let deviation = |k: f64, mean: f64| (1.0 / (2.0 * k + 1.0) - mean * mean).sqrt();
        assert_moments(
            moments(centred),
            [0.0, 1.0 / 3.0, 0.0, 0.2],
            [
                deviation(1.0, 0.0),
                deviation(2.0, 1.0 / 3.0),
                deviation(3.0, 0.0),
                deviation(4.0, 0.2),
            ],
        );
        let root = f64::sqrt;
        assert_moments(
            moments(Address::gaussian),
            [0.0, 1.0, 0.0, 3.0],
            [1.0, root(2.0), root(15.0), root(105.0 - 9.0)],
        );
    }

    #[test]
    fn every_part_of_an_address_counts() {
        let here = Address { seed: 1, trajectory: 2, step: 3, purpose: Purpose::StepTime };
        let others = [
            Address { seed: 1 << 40, ..here },
            Address { trajectory: 2 | 1 << 50, ..here },
            Address { step: 3 | 1 << 60, ..here },
            Address { purpose: Purpose::ClockRate, ..here },
            // Not as if the two were one number.
            Address { trajectory: 3, step: 2, ..here },
        ];
        for other in others {
            assert_ne!(here.bits(), other.bits(), "{other:?}");
        }
    }
}
