//! Distributions of parameters of episodes.

use libration_core::Float;
use libration_core::control::ControlError;
use libration_core::random::{Address, Purpose};

use super::start::Episode;

/// The distribution of a number that is drawn at the beginning of every episode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Distribution {
    /// Uniform between two ends.
    Uniform(f64, f64),
    /// Between two ends above zero, each power of it as likely: for what may be several times too large or too small.
    LogUniform(f64, f64),
    /// Gaussian, of this mean and standard deviation: any number can be drawn, to 8.6 deviations from the mean.
    Normal(f64, f64),
    /// Above zero, of this mean and standard deviation, and Gaussian in its logarithm.
    LogNormal(f64, f64),
    /// One of two values: the first with this probability.
    Either(f64, [f64; 2]),
}

/// Standard deviations from the mean of a normal distribution to the largest number that is drawn.
const FARTHEST: f64 = 8.6;

impl Distribution {
    /// Checks the parameters, in the float type as well.
    pub(super) fn check<T: Float>(&self, index: usize) -> Result<(), ControlError> {
        let ensure = |name, value, allowed, holds: bool| {
            let error = ControlError { name, index: Some(index), value, allowed };
            if holds { Ok(()) } else { Err(error) }
        };
        let finite = |name, value: f64| {
            ensure(name, value, "finite in the float type", T::from_f64(value).is_finite())
        };
        match *self {
            Distribution::Uniform(low, high) => {
                let (width, allowed) = (high - low, "a finite number of at least 0");
                ensure(
                    "width of the variation",
                    width,
                    allowed,
                    (0.0..f64::INFINITY).contains(&width),
                )?;
                finite("lower end of the variation", low)?;
                finite("upper end of the variation", high)
            }
            Distribution::LogUniform(low, high) => {
                let held = T::from_f64(low) > T::zero();
                ensure("lower end of the variation", low, "above 0 in the float type", held)?;
                ensure("upper end of the variation", high, "at least the lower", high >= low)?;
                finite("upper end of the variation", high)
            }
            Distribution::Normal(mean, deviation) => {
                finite("mean of the variation", mean)?;
                let (name, allowed) = ("standard deviation of the variation", "at least 0");
                ensure(name, deviation, allowed, deviation >= 0.0)?;
                finite(
                    "sum of mean and standard deviations of the variation",
                    mean.abs() + FARTHEST * deviation,
                )
            }
            Distribution::LogNormal(mean, deviation) => {
                let held = T::from_f64(mean) > T::zero();
                ensure("mean of the variation", mean, "above 0 in the float type", held)?;
                let (name, allowed) = ("standard deviation of the variation", "at least 0");
                ensure(name, deviation, allowed, deviation >= 0.0)?;
                let [low, high] = ends_of_logarithm(mean, deviation);
                let held = T::from_f64(low) > T::zero();
                ensure("smallest number of the variation", low, "above 0 in the float type", held)?;
                finite("largest number of the variation", high)
            }
            Distribution::Either(first, values) => {
                let holds = (0.0..=1.0).contains(&first);
                ensure("probability of the variation", first, "from 0 to 1", holds)?;
                values.into_iter().try_for_each(|value| finite("value of the variation", value))
            }
        }
    }

    /// The smallest number; minus infinity where there is none.
    // As the environments by programs, which alone need it.
    #[cfg(not(test))]
    pub(super) fn least(&self) -> f64 {
        match *self {
            Distribution::Uniform(low, _) | Distribution::LogUniform(low, _) => low,
            Distribution::Normal(mean, 0.0) => mean,
            Distribution::Normal(..) => f64::NEG_INFINITY,
            Distribution::LogNormal(mean, deviation) => ends_of_logarithm(mean, deviation)[0],
            Distribution::Either(_, [a, b]) => a.min(b),
        }
    }

    /// The largest number; of normal distributions, also of the logarithm, eight standard deviations above the mean.
    // As above.
    #[cfg(not(test))]
    pub(super) fn largest(&self) -> f64 {
        match *self {
            Distribution::Uniform(_, high) | Distribution::LogUniform(_, high) => high,
            Distribution::Normal(mean, deviation) | Distribution::LogNormal(mean, deviation) => {
                mean + 8.0 * deviation
            }
            Distribution::Either(_, [a, b]) => a.max(b),
        }
    }

    /// The `i`-th number of an episode.
    pub(super) fn draw(&self, episode: Episode, purpose: Purpose, i: usize) -> f64 {
        self.draw_at(episode.address(purpose, i))
    }

    /// The number of an address.
    pub(super) fn draw_at(&self, address: Address) -> f64 {
        let [share, _] = address.uniform();
        match *self {
            Distribution::Uniform(low, high) => low + share * (high - low),
            Distribution::LogUniform(low, high) => {
                let (least, most) = (libm::log(low), libm::log(high));
                // Rounded, the ends themselves may be passed.
                libm::exp(least + share * (most - least)).clamp(low, high)
            }
            Distribution::Normal(mean, deviation) => mean + deviation * address.gaussian()[0],
            Distribution::LogNormal(mean, deviation) => {
                let [middle, width] = of_logarithm(mean, deviation);
                libm::exp(middle + width * address.gaussian()[0])
            }
            Distribution::Either(first, [a, b]) => {
                if share < first {
                    a
                } else {
                    b
                }
            }
        }
    }
}

/// Mean and standard deviation of the logarithm of a number with these.
///
/// N. L. Johnson, S. Kotz, N. Balakrishnan, *Continuous univariate distributions*, volume 1, 1994, chapter 14.
fn of_logarithm(mean: f64, deviation: f64) -> [f64; 2] {
    let ratio = deviation / mean;
    let variance = libm::log1p(ratio * ratio);
    [libm::log(mean) - variance / 2.0, variance.sqrt()]
}

/// The smallest and the largest number that is drawn.
fn ends_of_logarithm(mean: f64, deviation: f64) -> [f64; 2] {
    let [middle, width] = of_logarithm(mean, deviation);
    [middle - FARTHEST * width, middle + FARTHEST * width].map(libm::exp)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The mean, the variance, the smallest and the largest of the draws.
    fn drawn(distribution: Distribution) -> [f64; 4] {
        const COUNT: u64 = 1 << 16;
        let episode = |number| Episode { seed: 11, environment: 3, number };
        let numbers = (0..COUNT).map(|k| distribution.draw(episode(k), Purpose::Variation, 2));
        let mut told = [0.0, 0.0, f64::INFINITY, f64::NEG_INFINITY];
        for x in numbers {
            told = [told[0] + x, told[1] + x * x, told[2].min(x), told[3].max(x)];
        }
        let [mean, square] = [told[0], told[1]].map(|sum| sum / COUNT as f64);
        [mean, square - mean * mean, told[2], told[3]]
    }

    #[test]
    fn numbers_have_the_mean_and_the_variance_of_their_distribution() {
        let (log, ratio) = (4.0_f64.ln(), 0.3);
        // Means, variances, and the ends that are not passed.
        for (distribution, mean, variance, ends) in [
            (Distribution::Uniform(1.0, 4.0), 2.5, 0.75, [1.0, 4.0]),
            (
                Distribution::LogUniform(1.0, 4.0),
                3.0 / log,
                7.5 / log - 9.0 / (log * log),
                [1.0, 4.0],
            ),
            (Distribution::Normal(1.0, 0.5), 1.0, 0.25, [1.0 - 4.3, 1.0 + 4.3]),
            // A fourth moment of 2.7 squared variances of the sample is below the three that the tolerance allows.
            (Distribution::LogNormal(2.0, 0.2), 2.0, 0.04, [0.0, 2.0 * 2.36]),
            (Distribution::Either(ratio, [2.0, 5.0]), 4.1, 9.0 * ratio * (1.0 - ratio), [2.0, 5.0]),
        ] {
            let found = drawn(distribution);
            // Four standard errors of 2¹⁶ draws, whose fourth moments are at most three squared variances.
            assert!(
                (found[0] - mean).abs() < 4.0 * variance.sqrt() / 256.0,
                "{distribution:?} {found:?}"
            );
            assert!(
                (found[1] - variance).abs() < 4.0 * variance * 2.0_f64.sqrt() / 256.0,
                "{distribution:?} {found:?}"
            );
            assert!(found[2] >= ends[0] && found[3] <= ends[1], "{distribution:?} {found:?}");
        }
    }
}
