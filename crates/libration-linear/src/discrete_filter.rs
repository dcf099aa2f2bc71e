//! Filters of samples.

use core::f64::consts::PI;

use num_complex::Complex64;
use thiserror::Error;

use crate::{DiscreteController, Matrix};

/// A filter of the samples of a channel, which runs once per period with the controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DiscreteFilter {
    /// The mean of the last so many samples.
    MovingAverage(usize),
    /// The difference of the last two samples over the period: the derivative per second.
    Difference,
}

/// Error of a filter of samples.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum DiscreteFilterError {
    /// The number of samples is invalid.
    #[error("`{name}` averages {samples} samples; expected 1 to {}", DiscreteFilter::MOST_SAMPLES)]
    Samples {
        /// The name of the filter.
        name: String,
        /// The number of samples.
        samples: usize,
    },
}

impl DiscreteFilter {
    /// The most samples of a moving average.
    pub const MOST_SAMPLES: usize = 100;

    /// Fails if its number is invalid.
    ///
    /// # Errors
    /// [`DiscreteFilterError`].
    pub fn check(self, name: &str) -> Result<(), DiscreteFilterError> {
        match self {
            DiscreteFilter::MovingAverage(samples)
                if !(1..=Self::MOST_SAMPLES).contains(&samples) =>
            {
                Err(DiscreteFilterError::Samples { name: name.to_owned(), samples })
            }
            _ => Ok(()),
        }
    }

    /// The factors of the last samples, the latest first, in periods of `period` seconds.
    fn taps(self, period: f64) -> Vec<f64> {
        match self {
            DiscreteFilter::MovingAverage(samples) => vec![(samples as f64).recip(); samples],
            DiscreteFilter::Difference => vec![period.recip(), -period.recip()],
        }
    }

    /// The delay at low frequencies, in s: `(k − 1)/2` periods of a mean of `k` samples, and half a period of a difference.
    pub fn delay(self, period: f64) -> f64 {
        let samples = match self {
            DiscreteFilter::MovingAverage(samples) => samples,
            DiscreteFilter::Difference => 2,
        };
        0.5 * (samples as f64 - 1.0) * period
    }

    /// The phase in rad at `omega` rad/s, from −π to π: that of its transfer function `Σ cₖ z⁻ᵏ` at `z = e^{iωh}`. A difference leads,
    /// as a derivative does.
    pub fn phase(self, omega: f64, period: f64) -> f64 {
        let turn = Complex64::from_polar(1.0, -omega * period);
        let taps = self.taps(period);
        let response = taps.iter().rev().fold(Complex64::ZERO, |sum, tap| sum * turn + tap);
        match response.arg() {
            // A half turn has one sign.
            phase if phase <= -PI => PI,
            phase => phase,
        }
    }

    /// The filter as a controller with one measurement and one command. It remembers the samples before the last.
    fn discrete(self, period: f64) -> DiscreteController {
        let taps = self.taps(period);
        let memory = taps.len() - 1;
        DiscreteController {
            a: Matrix::from_fn(memory, memory, |i, j| f64::from(u8::from(i == j + 1))),
            b: Matrix::from_fn(memory, 1, |i, _| f64::from(u8::from(i == 0))),
            c: Matrix::from_fn(1, memory, |_, j| taps[j + 1]),
            d: Matrix::diagonal(&taps[..1]),
        }
    }

    /// Filters of `channels` channels, each by its number, in the order in which samples pass them. Other channels pass as they are.
    pub fn bank(channels: usize, filters: &[(usize, Self)], period: f64) -> DiscreteController {
        let mut bank = DiscreteController::gain(Matrix::identity(channels));
        for &(channel, filter) in filters {
            let one = filter.discrete(period);
            let memory = one.memory();
            let mut all = DiscreteController {
                a: one.a,
                b: Matrix::zeros(memory, channels),
                c: Matrix::zeros(channels, memory),
                d: Matrix::identity(channels),
            };
            all.b.set_block((0, channel), &one.b);
            all.c.set_block((channel, 0), &one.c);
            all.d[(channel, channel)] = one.d[(0, 0)];
            bank = bank.then(&all);
        }
        bank
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a controller makes of samples, from an empty memory.
    fn filtered(controller: &DiscreteController, samples: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let mut memory = vec![0.0; controller.memory()];
        let sum = |a: Vec<f64>, b: Vec<f64>| a.iter().zip(b).map(|(a, b)| a + b).collect();
        let step = |y: &Vec<f64>| {
            let out = sum(controller.c.apply(&memory), controller.d.apply(y));
            memory = sum(controller.a.apply(&memory), controller.b.apply(y));
            out
        };
        samples.iter().map(step).collect()
    }

    #[test]
    fn a_bank_averages_and_differentiates_each_channel_in_order() {
        let filters = [
            (0, DiscreteFilter::MovingAverage(3)),
            (2, DiscreteFilter::Difference),
            (2, DiscreteFilter::MovingAverage(2)),
        ];
        let bank = DiscreteFilter::bank(3, &filters, 0.5);
        assert_eq!(bank.memory(), 2 + 1 + 1);
        let samples: Vec<Vec<f64>> =
            [[3.0, 7.0, 1.0], [6.0, 8.0, 2.0], [0.0, 9.0, 4.0]].map(|row| row.to_vec()).to_vec();
        let found = filtered(&bank, &samples);
        // The rates of the last are 2, 2 and 4 per second, and their means 1, 2 and 3.
        let wanted = [[1.0, 7.0, 1.0], [3.0, 8.0, 2.0], [3.0, 9.0, 3.0]];
        for (found, wanted) in found.iter().flatten().zip(wanted.iter().flatten()) {
            assert!((found - wanted).abs() < 1e-15, "{found} {wanted}");
        }
    }

    #[test]
    fn the_phase_of_an_average_is_its_delay_below_its_first_zero_and_turns_there() {
        let period = 0.002;
        for samples in [1, 2, 5, 8] {
            let filter = DiscreteFilter::MovingAverage(samples);
            let zero = 2.0 * PI / (samples as f64 * period);
            for part in [0.01, 0.3, 0.9] {
                let omega = part * zero;
                let wanted = -omega * filter.delay(period);
                assert!((filter.phase(omega, period) - wanted).abs() < 1e-12, "{samples} {part}");
            }
        }
        let beyond = DiscreteFilter::MovingAverage(2).phase(1.5 * PI / period, period);
        assert!((beyond - 0.25 * PI).abs() < 1e-12, "{beyond}");
        // A derivative turns by a quarter, less the delay of half a period.
        let phase = DiscreteFilter::Difference.phase(100.0, period);
        assert!((phase - (0.5 * PI - 100.0 * 0.001)).abs() < 1e-12, "{phase}");
    }

    #[test]
    fn a_mean_of_no_samples_is_refused() {
        for samples in [0, DiscreteFilter::MOST_SAMPLES + 1] {
            let error = DiscreteFilter::MovingAverage(samples).check("mean").unwrap_err();
            assert!(error.to_string().contains("expected 1 to 100"), "{error}");
        }
    }
}
