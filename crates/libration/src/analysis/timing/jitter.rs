//! Steps of random length.

use super::{Feedback, Plant};
use crate::analysis::eigenvalues::largest_root;
use crate::number::Wide;
use crate::{Scalar, State};

/// The law of step times `Δt(1 + ε)`, drawn independently for every step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Jitter {
    /// `ε` is Gaussian, with this standard deviation.
    Gaussian(f64),
    /// `ε` is uniform about zero, with this standard deviation.
    Uniform(f64),
}

impl Jitter {
    /// `E[εᵏ]`.
    fn moment(self, k: usize) -> Wide {
        if k % 2 == 1 {
            return Wide::ZERO;
        }
        let half = (k / 2) as u64;
        match self {
            // σᵏ·(k − 1)!!
            Jitter::Gaussian(rms) => (1..k as i32)
                .step_by(2)
                .fold(Wide::from_f64(rms).powi(k as u64), |product, odd| product.ratio(odd, 1)),
            // Half the width is √3·σ.
            Jitter::Uniform(rms) => {
                let square = Wide::from_f64(rms).powi(2).ratio(3, 1);
                square.powi(half).ratio(1, 1 + k as i32)
            }
        }
    }
}

impl Jitter {
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

/// What random step times do to second moments.
#[derive(Clone, Copy, Debug)]
pub struct MeanSquare {
    /// `ρ(E[M ⊗ M])`: the factor by which second moments grow in a step.
    pub radius: Wide,
    /// `E[M ⊗ M]` on `q²`, `qv` and `v²`, row by row.
    operator: [Wide; 9],
}

impl MeanSquare {
    /// `E[q²]`, `E[qv]` and `E[v²]` after so many steps from `state`.
    pub fn moments(&self, state: &State<f64, 1>, steps: u64) -> [f64; 3] {
        let [q, v] = [state.q[0], state.v[0]].map(Wide::from_f64);
        let mut moments = [q * q, q * v, v * v];
        for _ in 0..steps {
            moments = core::array::from_fn(|i| {
                (0..3).fold(Wide::ZERO, |sum, j| sum + self.operator[3 * i + j] * moments[j])
            });
        }
        moments.map(Wide::to_f64)
    }
}

/// Powers of `ε` that are kept: more than the square of a step of any built-in method has. Of an exact one those are
/// left out that fall as `(2ωΔt·ε)⁹⁶/96!`.
const POWERS: usize = 96;

/// Between the step times at which a step is taken to find its powers: `2^−SPACING` of `Δt`.
const SPACING: i64 = 4;

impl Plant<'_> {
    /// The growth of second moments in the loop that `feedback` closes, with steps after `jitter`.
    ///
    /// `E[M ⊗ M]` is exact: the entries of `M` are polynomials in `ε`, found by interpolation in 1024 bits, and
    /// of those the moments of the law are known. A clock that lets no step be negative has another law where
    /// `ε < −1` is likely.
    pub fn mean_square(&self, feedback: Feedback, jitter: Jitter) -> MeanSquare {
        let half = (POWERS / 2) as i64;
        let node = |i: usize| Wide::from_f64((i as i64 - half) as f64).scaled(-SPACING);
        let nodes: Vec<Wide> = (0..POWERS).map(node).collect();
        let squares: Vec<[Wide; 9]> = nodes
            .iter()
            .map(|&epsilon| {
                let step = self.closed(feedback, self.dt * (Wide::one() + epsilon));
                square([0, 1].map(|i| [0, 1].map(|j| step.entry(i, j))))
            })
            .collect();
        let mean: [Wide; 9] = core::array::from_fn(|entry| {
            let values = squares.iter().map(|square| square[entry]).collect();
            let powers = interpolated(&nodes, values);
            (0..).zip(powers).fold(Wide::ZERO, |sum, (k, c)| sum + c * jitter.moment(k))
        });
        MeanSquare { radius: radius(mean), operator: mean }
    }
}

/// The spectral radius of a matrix of three rows.
fn radius([a, b, c, d, e, f, g, h, i]: [Wide; 9]) -> Wide {
    let minors = [e * i - f * h, a * i - c * g, a * e - b * d];
    let determinant = a * minors[0] - b * (d * i - f * g) + c * (d * h - e * g);
    let sum = minors[0] + minors[1] + minors[2];
    largest_root(&[-determinant, sum, -(a + e + i)])
}

/// What a step makes of `q²`, `qv` and `v²`, row by row: `M ⊗ M` on what is symmetric.
fn square([[a, b], [c, d]]: [[Wide; 2]; 2]) -> [Wide; 9] {
    [a * a, (a * b).scaled(1), b * b, a * c, a * d + b * c, b * d, c * c, (c * d).scaled(1), d * d]
}

/// The coefficients of the polynomial through these points, by Newton's divided differences.
fn interpolated(nodes: &[Wide], mut values: Vec<Wide>) -> Vec<Wide> {
    let n = nodes.len();
    for level in 1..n {
        for i in (level..n).rev() {
            values[i] = (values[i] - values[i - 1]) / (nodes[i] - nodes[i - level]);
        }
    }
    let mut coefficients = vec![Wide::ZERO; n];
    for i in (0..n).rev() {
        // c ← c·(ε − node) + value.
        for k in (0..n).rev() {
            let below = if k > 0 { coefficients[k - 1] } else { values[i] };
            coefficients[k] = below - coefficients[k] * nodes[i];
        }
    }
    coefficients
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_polynomial_is_found_from_its_values() {
        let nodes: Vec<Wide> = (0..9).map(|i| Wide::from_f64(f64::from(i) / 8.0)).collect();
        let at = |x: Wide| Wide::from_f64(3.0) - x.scaled(1) + x.powi(4).ratio(7, 1);
        let found = interpolated(&nodes, nodes.iter().map(|&x| at(x)).collect());
        let wanted = [3.0, -2.0, 0.0, 0.0, 7.0, 0.0, 0.0, 0.0, 0.0];
        for (c, wanted) in found.into_iter().zip(wanted) {
            assert!((c.to_f64() - wanted).abs() < 1e-290);
        }
    }

    #[test]
    fn sums_over_nodes_are_moments() {
        for law in [Jitter::Gaussian(0.3), Jitter::Uniform(0.3)] {
            for k in 0..9 {
                let sum: f64 = law.nodes().iter().map(|(weight, x)| weight * x.powi(k)).sum();
                let moment = law.moment(k as usize).to_f64();
                assert!((sum - moment).abs() < 1e-15, "{law:?} {k}: {sum} {moment}");
            }
        }
    }

    #[test]
    fn moments_are_those_of_the_laws() {
        let sixth = |law: Jitter| law.moment(6).to_f64();
        assert_eq!(sixth(Jitter::Gaussian(1.0)), 15.0);
        // (√3)⁶/7.
        assert_eq!(sixth(Jitter::Uniform(1.0)), 27.0 / 7.0);
        assert_eq!(Jitter::Gaussian(2.0).moment(0).to_f64(), 1.0);
        assert_eq!(Jitter::Uniform(0.3).moment(3).to_f64(), 0.0);
    }
}
