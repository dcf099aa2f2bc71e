//! The Lyapunov exponent of a loop with random step times.

use core::f64::consts::{PI, TAU};

use libration_core::Scalar;
use libration_core::control::{Feedback, Jitter};
use libration_core::number::Wide;
use libration_linear::{Averages, MOST_TURN, solve};
use num_complex::Complex;

use super::Plant;
use super::circular_coordinates::{CircularCoordinates, Matrix, norm};
use crate::QuadraticForm;

/// Fewest and most harmonics of the density of directions that are kept.
const HARMONICS: [f64; 2] = [32.0, 96.0];

/// Harmonics for steps that stretch one direction so many times as much as another: sharper densities need more.
fn harmonics(steps: &[(f64, Matrix)]) -> usize {
    let stretch = |m: &Matrix| {
        let [[a, b], [c, d]] = *m;
        norm(m).powi(2) / (a * d - b * c).abs()
    };
    let most =
        steps.iter().map(|(_, step)| stretch(step)).filter(|x| x.is_finite()).fold(1.0, f64::max);
    let [fewest, limit] = HARMONICS;
    (8.0 * most).clamp(fewest, limit) as usize
}

impl Plant<'_> {
    /// The top Lyapunov exponent of the loop that `feedback` closes, with steps after `jitter`: the mean growth of
    /// `ln |y|` in a step. None where the step of mean length does not turn the state.
    ///
    /// It is the mean of the growth over directions in their invariant density, which the transfer operator on the
    /// projective circle leaves as it is (H. Furstenberg, *Noncommuting random products*, Transactions of the
    /// American Mathematical Society 108, 1963); density and operator are taken as Fourier series, in coordinates in
    /// which the mean step is a turn. Where steps stretch some directions a hundred times as much as others, three digits are
    /// right.
    pub fn lyapunov_exponent(&self, feedback: Feedback, jitter: Jitter) -> Option<f64> {
        let at = |epsilon: f64| {
            let step = self.closed(feedback, self.dt * (Wide::one() + Wide::from_f64(epsilon)));
            [0, 1].map(|i| [0, 1].map(|j| step.entry(i, j).to_f64()))
        };
        let mean = self.closed(feedback, self.dt);
        let half = mean.trace().scaled(-1);
        let determinant = mean.determinant();
        if (determinant - half * half).to_f64() <= 0.0 {
            return None;
        }
        let turn = 2.0 * self.turn(jitter);
        if turn.is_nan() || turn > MOST_TURN {
            return None;
        }
        // The form that the mean step carries along is a circle in these coordinates.
        let form = QuadraticForm::carried_by(&mean);
        let circle = CircularCoordinates::of(&form.map(|x| (x / form.vv).to_f64()));
        let steps: Vec<(f64, Matrix)> = jitter
            .nodes(turn)
            .into_iter()
            .map(|(weight, epsilon)| (weight, circle.turned(at(epsilon))))
            .collect();
        Some(mean_growth(&steps))
    }
}

/// The mean of `ln |Mu|` over directions in their invariant density, of a matrix for each weight.
fn mean_growth(steps: &[(f64, Matrix)]) -> f64 {
    let harmonics = harmonics(steps);
    // Four for each wave of the highest.
    let directions = 8 * harmonics;
    // For each harmonic k of the doubled angle x: the mean of e^{ikx} after a step from each direction.
    let waves = 2 * harmonics + 1;
    let mut after = vec![vec![Complex::ZERO; directions]; harmonics + 1];
    let mut growth = vec![Complex::ZERO; directions];
    for (n, growth) in growth.iter_mut().enumerate() {
        let (sine, cosine) = (PI * n as f64 / directions as f64).sin_cos();
        for &(weight, [[a, b], [c, d]]) in steps {
            let (x, y) = (a * cosine + b * sine, c * cosine + d * sine);
            let square = x * x + y * y;
            *growth += weight * 0.5 * square.ln();
            // e^{ix} with the doubled angle.
            let turn = Complex::new(x * x - y * y, 2.0 * x * y) / square;
            let mut power = Complex::from(weight);
            for harmonic in &mut after {
                harmonic[n] += power;
                power *= turn;
            }
        }
    }
    // Coefficients of a function of direction: Σ cₘ e^{imx}.
    let roots: Vec<Complex<f64>> = (0..directions)
        .map(|k| Complex::from_polar(1.0, -TAU * k as f64 / directions as f64))
        .collect();
    let coefficient = |values: &[Complex<f64>], m: isize| {
        let root = |n: usize| roots[(m * n as isize).rem_euclid(directions as isize) as usize];
        values.iter().enumerate().map(|(n, value)| value * root(n)).sum::<Complex<f64>>()
            / directions as f64
    };
    let order = |i: usize| i as isize - harmonics as isize;
    // Unknown: fₘ, the mean of e^{imx} in the invariant density. It is what it is after a step.
    let mut rows = vec![vec![Complex::ZERO; waves + 1]; waves];
    for (i, row) in rows.iter_mut().enumerate() {
        let k = order(i);
        if k == 0 {
            row[i] = Complex::ONE;
            row[waves] = Complex::ONE;
            continue;
        }
        for (j, entry) in row[..waves].iter_mut().enumerate() {
            // After −k as after k, conjugate.
            let sign = k.signum();
            let value = coefficient(&after[k.unsigned_abs()], sign * order(j));
            *entry = if sign < 0 { value.conj() } else { value };
        }
        row[i] -= Complex::ONE;
    }
    let means = solve(rows, |x: Complex<f64>| x.norm());
    means.iter().enumerate().map(|(j, f)| (coefficient(&growth, order(j)) * f).re).sum()
}
