//! Laws of intervals and latencies.

use std::f64::consts::{PI, SQRT_2};

use serde::Serialize;

use super::two_values::{TwoValues, normal_density, two_values};

/// A law with its parameters.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "law", rename_all = "kebab-case")]
pub enum Law {
    /// Mean and standard deviation, in s.
    Gaussian {
        /// The mean.
        mean: f64,
        /// The standard deviation.
        deviation: f64,
    },
    /// From one bound to another, in s.
    Uniform {
        /// The lower bound.
        from: f64,
        /// The upper bound.
        to: f64,
    },
    /// A smallest value with an exponential tail above it, in s.
    Exponential {
        /// The smallest value.
        from: f64,
        /// The mean above it.
        scale: f64,
    },
    /// Exponential tails on both sides (Laplace), in s.
    Laplace {
        /// The median.
        median: f64,
        /// The mean distance from it.
        scale: f64,
    },
    /// Two values, each with a Gaussian spread, in s.
    TwoValued {
        /// The means.
        values: [f64; 2],
        /// The standard deviations.
        deviations: [f64; 2],
        /// The share of the second value.
        share: f64,
    },
}

/// The kind of a law.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LawKind {
    /// [`Law::Gaussian`].
    Gaussian,
    /// [`Law::Uniform`].
    Uniform,
    /// [`Law::Exponential`].
    Exponential,
    /// [`Law::Laplace`].
    Laplace,
    /// [`Law::TwoValued`].
    TwoValued,
}

impl LawKind {
    /// All kinds.
    pub const ALL: [LawKind; 5] = [
        LawKind::Gaussian,
        LawKind::Uniform,
        LawKind::Exponential,
        LawKind::Laplace,
        LawKind::TwoValued,
    ];

    /// The law of greatest likelihood for sorted values; none if they do not determine one.
    pub fn fit(self, sorted: &[f64]) -> Option<Law> {
        let (&first, &last) = (sorted.first()?, sorted.last()?);
        let count = sorted.len() as f64;
        let mean = sorted.iter().sum::<f64>() / count;
        if sorted.len() < 8 || first >= last {
            return None;
        }
        Some(match self {
            LawKind::Gaussian => {
                let square = sorted.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / count;
                Law::Gaussian { mean, deviation: square.sqrt() }
            }
            // Without bias: the range of n values is short by two parts in n + 1.
            LawKind::Uniform => {
                let margin = (last - first) / (count - 1.0);
                Law::Uniform { from: first - margin, to: last + margin }
            }
            LawKind::Exponential => {
                let from = first - (mean - first) / count;
                Law::Exponential { from, scale: mean - from }
            }
            LawKind::Laplace => {
                let median = sorted[sorted.len() / 2];
                let scale = sorted.iter().map(|x| (x - median).abs()).sum::<f64>() / count;
                Law::Laplace { median, scale }
            }
            LawKind::TwoValued => {
                let TwoValues { values, deviations, share } = two_values(sorted)?;
                Law::TwoValued { values, deviations, share }
            }
        })
    }

    /// The number of parameters.
    pub fn parameters(self) -> usize {
        if self == LawKind::TwoValued { 5 } else { 2 }
    }

    /// The name.
    pub fn name(self) -> &'static str {
        match self {
            LawKind::Gaussian => "gaussian",
            LawKind::Uniform => "uniform",
            LawKind::Exponential => "exponential tail",
            LawKind::Laplace => "exponential tails on both sides",
            LawKind::TwoValued => "two-valued",
        }
    }
}

impl Law {
    /// The logarithm of the density at `x`.
    pub fn log_density(&self, x: f64) -> f64 {
        match *self {
            Law::Gaussian { mean, deviation } => {
                let z = (x - mean) / deviation;
                -0.5 * z * z - (deviation * (2.0 * PI).sqrt()).ln()
            }
            Law::Uniform { from, to } if (from..=to).contains(&x) => -(to - from).ln(),
            Law::Exponential { from, scale } if x >= from => -(x - from) / scale - scale.ln(),
            Law::Uniform { .. } | Law::Exponential { .. } => f64::NEG_INFINITY,
            Law::Laplace { median, scale } => -(x - median).abs() / scale - (2.0 * scale).ln(),
            Law::TwoValued { values, deviations, share } => {
                let density =
                    |i: usize| normal_density((x - values[i]) / deviations[i]) / deviations[i];
                ((1.0 - share) * density(0) + share * density(1)).max(f64::MIN_POSITIVE).ln()
            }
        }
    }

    /// The probability of values up to `x`.
    pub fn probability(&self, x: f64) -> f64 {
        match *self {
            Law::Gaussian { mean, deviation } => normal_probability((x - mean) / deviation),
            Law::Uniform { from, to } => ((x - from) / (to - from)).clamp(0.0, 1.0),
            Law::Exponential { from, scale } => -(-(x - from).max(0.0) / scale).exp_m1(),
            Law::Laplace { median, scale } if x < median => 0.5 * ((x - median) / scale).exp(),
            Law::Laplace { median, scale } => 1.0 - 0.5 * (-(x - median) / scale).exp(),
            Law::TwoValued { values, deviations, share } => {
                let part = |i: usize| normal_probability((x - values[i]) / deviations[i]);
                (1.0 - share) * part(0) + share * part(1)
            }
        }
    }
}

/// The normal distribution. Source: W. J. Cody, *Rational Chebyshev approximation for the error function*, as the series and the
/// continued fraction of the complementary error function (M. Abramowitz, I. Stegun, 7.1.5 and 7.1.14).
fn normal_probability(z: f64) -> f64 {
    let x = z.abs() / SQRT_2;
    let upper = if x < 2.5 {
        let (mut term, mut sum) = (x, x);
        for n in 1..60 {
            let n = f64::from(n);
            term *= -x * x / n;
            sum += term / (2.0 * n + 1.0);
        }
        0.5 - sum / PI.sqrt()
    } else {
        let fraction = (1..=60).rev().fold(x, |rest, n| x + 0.5 * f64::from(n) / rest);
        0.5 * (-x * x).exp() / (PI.sqrt() * fraction)
    };
    if z > 0.0 { 1.0 - upper } else { upper }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_normal_distribution_has_the_values_of_tables() {
        // Values of scipy.stats.norm.cdf.
        for (z, wanted) in [
            (0.0, 0.5),
            (1.0, 0.841_344_746_068_542_9),
            (-2.0, 0.022_750_131_948_179_21),
            (3.5, 0.999_767_370_920_964_5),
            (-6.0, 9.865_876_450_376_98e-10),
        ] {
            let found = normal_probability(z);
            assert!((found - wanted).abs() < 1e-14 + 1e-12 * wanted, "{z}: {found}");
        }
    }

    #[test]
    fn probabilities_are_the_integrals_of_densities() {
        let laws = [
            Law::Gaussian { mean: 1.0, deviation: 0.3 },
            Law::Uniform { from: 0.5, to: 1.5 },
            Law::Exponential { from: 0.8, scale: 0.2 },
            Law::Laplace { median: 1.0, scale: 0.2 },
            Law::TwoValued { values: [0.7, 1.4], deviations: [0.1, 0.2], share: 0.3 },
        ];
        for law in laws {
            let (from, to, n) = (0.61, 1.33, 20_000);
            let h = (to - from) / f64::from(n);
            let middle = |i: i32| law.log_density(from + (f64::from(i) + 0.5) * h).exp() * h;
            let integral: f64 = (0..n).map(middle).sum();
            let wanted = law.probability(to) - law.probability(from);
            // The kink of a density costs one interval.
            assert!((integral - wanted).abs() < 5.0 * h, "{law:?}: {integral} {wanted}");
        }
    }
}
