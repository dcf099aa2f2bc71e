//! Steps of random length.

use crate::Scalar;
use crate::number::Wide;
use crate::random::LARGEST;

/// The law of step times `Δt(1 + ε)`, drawn independently for every step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Jitter {
    /// `ε` is Gaussian, with this standard deviation.
    Gaussian(f64),
    /// `ε` is uniform about zero, with this standard deviation.
    Uniform(f64),
}

impl Jitter {
    /// `E[1], E[ε²], E[ε⁴], …`; the odd ones vanish.
    pub(super) fn even_moments(self) -> impl Iterator<Item = Wide> {
        let square = match self {
            Jitter::Gaussian(rms) => Wide::from_f64(rms).powi(2),
            // Half the width is √3·σ.
            Jitter::Uniform(rms) => Wide::from_f64(rms).powi(2).ratio(3, 1),
        };
        // σᵏ·(k − 1)!!, and (√3·σ)ᵏ/(k + 1).
        core::iter::successors(Some((1, Wide::one())), move |&(odd, moment)| {
            let next = match self {
                Jitter::Gaussian(_) => (moment * square).ratio(odd, 1),
                Jitter::Uniform(_) => (moment * square).ratio(odd, odd + 2),
            };
            Some((odd + 2, next))
        })
        .map(|(_, moment)| moment)
    }
}

impl Jitter {
    /// The standard deviation of `ε`.
    pub fn rms(self) -> f64 {
        match self {
            Jitter::Gaussian(rms) | Jitter::Uniform(rms) => rms,
        }
    }

    /// The largest `|ε|` that is drawn in a simulation, whose Gaussian numbers end at [`LARGEST`] deviations.
    pub fn largest(self) -> f64 {
        match self {
            Jitter::Gaussian(rms) => f64::from(LARGEST) * rms,
            Jitter::Uniform(rms) => 3.0_f64.sqrt() * rms,
        }
    }

    /// Weights and values of `ε` whose sums are means over the law, but for rounding, of what is smooth.
    pub(super) fn nodes(self) -> Vec<(f64, f64)> {
        match self {
            // The trapezoidal rule on a Gaussian errs by exp(−2π²/h²) only: h = ½, to ten deviations.
            Jitter::Gaussian(rms) => {
                let at = |j: i32| f64::from(j) / 2.0;
                let weight = |x: f64| (-x * x / 2.0).exp();
                let all: f64 = (-20..=20).map(|j| weight(at(j))).sum();
                (-20..=20).map(|j| (weight(at(j)) / all, at(j) * rms)).collect()
            }
            Jitter::Uniform(rms) => {
                let half = 3.0_f64.sqrt() * rms;
                legendre(24).into_iter().map(|(weight, x)| (weight / 2.0, half * x)).collect()
            }
        }
    }
}

/// Weights and nodes of Gauss's quadrature on `[−1, 1]`, by Newton's iteration on Legendre's polynomial.
fn legendre(n: usize) -> Vec<(f64, f64)> {
    let polynomial = |x: f64| {
        let (mut before, mut value) = (1.0, x);
        for k in 2..=n {
            let k = k as f64;
            (before, value) = (value, ((2.0 * k - 1.0) * x * value - (k - 1.0) * before) / k);
        }
        let slope = n as f64 * (x * value - before) / (x * x - 1.0);
        (value, slope)
    };
    let node = |i: usize| {
        let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
        for _ in 0..8 {
            let (value, slope) = polynomial(x);
            x -= value / slope;
        }
        let (_, slope) = polynomial(x);
        (2.0 / ((1.0 - x * x) * slope * slope), x)
    };
    (0..n).map(node).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_over_nodes_are_moments() {
        for law in [Jitter::Gaussian(0.3), Jitter::Uniform(0.3)] {
            let even = law.even_moments().map(Wide::to_f64);
            let moments = even.flat_map(|moment| [moment, 0.0]);
            for (k, moment) in (0..9).zip(moments) {
                let sum: f64 = law.nodes().iter().map(|(weight, x)| weight * x.powi(k)).sum();
                assert!((sum - moment).abs() < 1e-15, "{law:?} {k}: {sum} {moment}");
            }
        }
    }

    #[test]
    fn moments_are_those_of_the_laws() {
        let moments =
            |law: Jitter| law.even_moments().take(4).map(Wide::to_f64).collect::<Vec<_>>();
        assert_eq!(moments(Jitter::Gaussian(1.0)), [1.0, 1.0, 3.0, 15.0]);
        assert_eq!(moments(Jitter::Gaussian(2.0))[..2], [1.0, 4.0]);
        // (√3)⁴/5 and (√3)⁶/7.
        assert_eq!(moments(Jitter::Uniform(1.0)), [1.0, 1.0, 1.8, 27.0 / 7.0]);
    }
}
