//! Mean-square stability under random step times.

use libration_core::control::{Feedback, Jitter};
use libration_core::number::Wide;
use libration_core::{Scalar, State};
use libration_linear::{Averages, MOST_TURN};

use super::Plant;
use crate::eigenvalues::largest_root;

/// The growth of second moments under random step times.
#[derive(Clone, Copy, Debug)]
pub struct MeanSquare {
    /// `ρ(E[M ⊗ M])`: the factor by which second moments grow in a step.
    pub radius: Wide,
    /// `E[M ⊗ M]` on `q²`, `qv` and `v²`, row by row.
    operator: [Wide; 9],
}

impl MeanSquare {
    /// `E[q²]`, `E[qv]` and `E[v²]` after `steps` steps from `state`.
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

/// `M ⊗ M` of a step of `Δt(1 + ε)` of a loop.
pub(super) struct Squares<'p> {
    plant: &'p Plant<'p>,
    feedback: Feedback,
    /// The coefficients of `1, ε, ε², …`, row by row.
    powers: Vec<[Wide; 9]>,
    /// Whether these powers are all that there is to it.
    follows: bool,
}

/// Bits to which the last powers must have fallen: what is left out then is less than an `f64` shows.
const SETTLED: i64 = 80;

impl Plant<'_> {
    /// The growth of second moments in the loop that `feedback` closes, with steps after `jitter`.
    ///
    /// `E[M ⊗ M]` is exact: the entries of `M` are polynomials in `ε`, found by interpolation in 1024 bits, and
    /// of those the moments of the law are known. Of exact steps, which are no polynomials, that holds as long as their powers
    /// settle; where they do not the mean is taken by quadrature in `f64`, and the radius is NaN where steps turn by more than 2048 rad
    /// in a deviation.
    pub fn mean_square(&self, feedback: Feedback, jitter: Jitter) -> MeanSquare {
        self.squares(feedback).mean(jitter)
    }

    /// `M ⊗ M` of a step of `Δt(1 + ε)`.
    fn square_at(&self, feedback: Feedback, epsilon: Wide) -> [Wide; 9] {
        let step = self.closed(feedback, self.dt * (Wide::one() + epsilon));
        square([0, 1].map(|i| [0, 1].map(|j| step.entry(i, j))))
    }

    /// The map of second moments of the loop that `feedback` closes.
    pub(super) fn squares(&self, feedback: Feedback) -> Squares<'_> {
        let half = (POWERS / 2) as i64;
        let node = |i: usize| Wide::from_f64((i as i64 - half) as f64).scaled(-SPACING);
        let nodes: Vec<Wide> = (0..POWERS).map(node).collect();
        let at = |epsilon: Wide| self.square_at(feedback, epsilon);
        let values: Vec<[Wide; 9]> = nodes.iter().map(|&epsilon| at(epsilon)).collect();
        let powers: [Vec<Wide>; 9] = core::array::from_fn(|entry| {
            interpolated(&nodes, values.iter().map(|square| square[entry]).collect())
        });
        let of = |k: usize| core::array::from_fn(|entry| powers[entry][k]);
        let powers: Vec<[Wide; 9]> = (0..POWERS).map(of).collect();
        // Between two nodes, near the end where a polynomial follows last.
        let between = nodes[POWERS - 2] + Wide::one().scaled(-SPACING - 1);
        let polynomial =
            |i: usize| powers.iter().rev().fold(Wide::ZERO, |sum, power| sum * between + power[i]);
        let there = at(between);
        let size = largest(there);
        let off = largest(core::array::from_fn(|i| polynomial(i) - there[i]));
        let follows = off <= size.scaled(-SETTLED);
        Squares { plant: self, feedback, powers, follows }
    }
}

impl Squares<'_> {
    /// The mean over `jitter`.
    pub(super) fn mean(&self, jitter: Jitter) -> MeanSquare {
        let operator = self.operator(jitter);
        let known = operator.iter().all(|x| !x.is_nan());
        let radius = if known { largest_root(&characteristic(operator)) } else { Wide::NAN };
        MeanSquare { radius, operator }
    }

    fn operator(&self, jitter: Jitter) -> [Wide; 9] {
        let moments: Vec<Wide> = jitter.moments().take(POWERS).collect();
        let term = |k: usize, i: usize| self.powers[k][i] * moments[k];
        let sum: [Wide; 9] =
            core::array::from_fn(|i| (0..POWERS).fold(Wide::ZERO, |sum, k| sum + term(k, i)));
        let rest = (POWERS - 8..POWERS).map(|k| largest(core::array::from_fn(|i| term(k, i))));
        let settled = rest.fold(Wide::ZERO, |most, x| if x > most { x } else { most });
        match self.follows && settled <= largest(sum).scaled(-SETTLED) {
            true => sum,
            false => self.by_nodes(jitter),
        }
    }

    /// The mean by quadrature, to the digits of an `f64`: of exact steps whose powers do not settle.
    fn by_nodes(&self, jitter: Jitter) -> [Wide; 9] {
        let turn = 2.0 * self.plant.turn(jitter);
        if turn > MOST_TURN {
            return [Wide::NAN; 9];
        }
        let nodes = jitter.nodes(turn);
        nodes.into_iter().fold([Wide::ZERO; 9], |sum, (weight, epsilon)| {
            let square = self.plant.square_at(self.feedback, Wide::from_f64(epsilon));
            core::array::from_fn(|i| sum[i] + Wide::from_f64(weight) * square[i])
        })
    }

    /// Whether `det(1 − E[M ⊗ M])` is positive, as it is from no jitter on up to where the radius is 1.
    pub(super) fn below_the_edge(&self, jitter: Jitter) -> bool {
        let coefficients = characteristic(self.operator(jitter));
        coefficients.into_iter().fold(Wide::one(), |sum, c| sum + c) > Wide::ZERO
    }
}

/// The largest size of an entry.
fn largest(entries: [Wide; 9]) -> Wide {
    let sizes = entries.into_iter().map(Wide::abs);
    sizes.fold(Wide::ZERO, |most, size| if size > most { size } else { most })
}

/// The lower coefficients of the characteristic polynomial of a matrix of three rows.
fn characteristic([a, b, c, d, e, f, g, h, i]: [Wide; 9]) -> [Wide; 3] {
    let minors = [e * i - f * h, a * i - c * g, a * e - b * d];
    let determinant = a * minors[0] - b * (d * i - f * g) + c * (d * h - e * g);
    let sum = minors[0] + minors[1] + minors[2];
    [-determinant, sum, -(a + e + i)]
}

/// The matrix of a step on `q²`, `qv` and `v²`, row by row: `M ⊗ M` on symmetric matrices.
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
}
