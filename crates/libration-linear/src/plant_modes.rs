//! Modes of a plant, and those that inputs do not reach or outputs do not show.

use core::f64::consts::TAU;

use num_complex::Complex64;

use crate::controllability::BalancedPair;
use crate::eigenvector::size_of;
use crate::{LinearPlant, Matrix, Signal, eigenvalues, eigenvector, solve};

/// A mode of a plant.
#[derive(Clone, Debug, PartialEq)]
pub struct PlantMode {
    /// The growth rate in 1/s; below zero the mode decays.
    pub growth_rate: f64,
    /// The frequency in Hz; 0 without oscillation.
    pub frequency: f64,
    /// The states that move most, with their sizes relative to the largest: at least a tenth of it, at most four.
    pub states: Vec<(String, f64)>,
}

impl core::fmt::Display for PlantMode {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let names: Vec<&str> = self.states.iter().map(|(name, _)| name.as_str()).collect();
        // Not the negative zero.
        let growth = (self.growth_rate * 1e4).round() / 1e4 + 0.0;
        write!(f, "the mode of {} (growth rate {growth:.4} 1/s", names.join(", "))?;
        match self.frequency {
            0.0 => write!(f, ")"),
            frequency => write!(f, ", {frequency:.4} Hz)"),
        }
    }
}

/// Relative change of the entries of a plant below which a mode that inputs reach counts as one out of reach: designs have no more
/// digits.
const NOTHING: f64 = 3e-8;

/// Part of the size of the plant below which a growth rate counts as zero: some roundings of its eigenvalues.
const NEUTRAL: f64 = 1e-12;

impl LinearPlant {
    /// Eigenvalues of the state matrix with their vectors, the one that grows fastest first; of a pair one.
    pub(crate) fn shapes(&self) -> Vec<(Complex64, Vec<Complex64>)> {
        let mut values = eigenvalues(&self.a).unwrap_or_default();
        values.retain(|value| value.im >= 0.0);
        let rate = |value: &Complex64| self.rate_of(*value).re;
        values.sort_by(|a, b| rate(b).total_cmp(&rate(a)));
        values.into_iter().filter_map(|value| Some((value, eigenvector(&self.a, value)?))).collect()
    }

    /// A mode that does not decay and that no input reaches.
    pub fn unreachable_mode(&self) -> Option<PlantMode> {
        self.hidden_mode(&self.a, &self.b)
    }

    /// A mode that does not decay and that no output shows.
    pub fn unobservable_mode(&self) -> Option<PlantMode> {
        self.hidden_mode(&self.a.transposed(), &self.c.transposed())
    }

    /// A mode that does not decay and that no noise drives.
    pub fn undisturbed_mode(&self) -> Option<PlantMode> {
        self.hidden_mode(&self.a, &self.g)
    }

    /// A mode that does not decay and that the cost `q`, a form of states, does not see. The feedback of least cost does not stabilise
    /// it.
    pub fn mode_without_cost(&self, q: &Matrix) -> Option<PlantMode> {
        self.hidden_mode(&self.a.transposed(), q)
    }

    /// By the test of Popov, Belevitch and Hautus: `[λ − A, B]` loses rank.
    fn hidden_mode(&self, a: &Matrix, b: &Matrix) -> Option<PlantMode> {
        let values = eigenvalues(a)?;
        let size = size_of(a);
        let pair = BalancedPair::new(a, b);
        let grows = |value: &&Complex64| match self.sampling_period {
            None => value.re >= -NEUTRAL * size,
            Some(_) => value.norm() >= 1.0 - NEUTRAL,
        };
        values.iter().filter(grows).find_map(|&value| {
            let is_hidden = pair.controllability(value) < NOTHING;
            is_hidden
                .then(|| left_vector(a, b, value))
                .flatten()
                .map(|vector| self.mode(value, &vector))
        })
    }

    pub(crate) fn mode(&self, value: Complex64, shape: &[Complex64]) -> PlantMode {
        let value = self.rate_of(value);
        PlantMode {
            growth_rate: value.re,
            frequency: value.im.abs() / TAU,
            states: largest(&self.states, shape),
        }
    }

    /// The eigenvalue in 1/s.
    pub(crate) fn rate_of(&self, value: Complex64) -> Complex64 {
        match self.sampling_period {
            None => value,
            Some(period) => value.ln() / period,
        }
    }
}

/// The signals that move most in a mode of this shape.
pub(crate) fn largest(signals: &[Signal], shape: &[Complex64]) -> Vec<(String, f64)> {
    let most = shape.iter().map(|x| x.norm()).fold(0.0, f64::max);
    let mut named: Vec<(String, f64)> = signals
        .iter()
        .zip(shape)
        .map(|(signal, x)| (signal.name.clone(), x.norm() / most))
        .filter(|(_, share)| *share >= 0.1)
        .collect();
    named.sort_by(|a, b| b.1.total_cmp(&a.1));
    named.truncate(4);
    named
}

/// The left vector of the smallest singular value of `[λ − A, B]`, with each column of `B` scaled to the size of `A`.
fn left_vector(a: &Matrix, b: &Matrix, value: Complex64) -> Option<Vec<Complex64>> {
    let n = a.rows();
    let size = size_of(a);
    let shifted = |i: usize, j: usize| {
        let own = if i == j { value } else { Complex64::ZERO };
        own - a[(i, j)]
    };
    let scales: Vec<f64> = (0..b.columns())
        .map(|k| (0..n).map(|i| b[(i, k)].abs()).fold(0.0, f64::max))
        .map(|most| if most > 0.0 { size / most } else { 0.0 })
        .collect();
    // M·Mᴴ, off by a rounding so that it has an inverse.
    let square = |i: usize, j: usize| {
        let inner: Complex64 = (0..n).map(|k| shifted(i, k) * shifted(j, k).conj()).sum();
        let driven: f64 =
            scales.iter().enumerate().map(|(k, s)| (s * b[(i, k)]) * (s * b[(j, k)])).sum();
        let own = if i == j { size * size * f64::EPSILON } else { 0.0 };
        inner + driven + own
    };
    let rows: Vec<Vec<Complex64>> =
        (0..n).map(|i| (0..n).map(|j| square(i, j)).collect()).collect();
    let mut vector: Vec<Complex64> =
        (0..n).map(|i| Complex64::from(1.0 / (1.0 + i as f64))).collect();
    for _ in 0..4 {
        let equations = rows.iter().zip(&vector).map(|(row, &x)| [row.as_slice(), &[x]].concat());
        let next = solve(equations.collect(), |x: Complex64| x.norm());
        let norm = next.iter().map(|x| x.norm_sqr()).sum::<f64>().sqrt();
        if !(norm.is_finite() && norm > 0.0) {
            return None;
        }
        vector = next.into_iter().map(|x| x / norm).collect();
    }
    Some(vector)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plant(a: &[&[f64]], b: &[&[f64]], c: &[&[f64]]) -> LinearPlant {
        let of = |rows: &[&[f64]]| Matrix::from_rows(rows).unwrap();
        let d = Matrix::zeros(c.len(), b[0].len());
        LinearPlant::new(of(a), of(b), of(c), d).unwrap()
    }

    #[test]
    fn a_slow_decay_beside_fast_ones_is_no_motion_out_of_reach() {
        // Rates of 1 and 10⁹, mixed with the eigenvectors (1, 1) and (1, −2).
        let rows = [[-333_333_334.0, 333_333_333.0], [666_666_666.0, -666_666_667.0]];
        let stiff = plant(&[&rows[0], &rows[1]], &[&[1.0], &[-2.0]], &[&[1.0, 0.0]]);
        assert_eq!(stiff.unreachable_mode(), None);
        let huge = plant(&[&[0.0, 1.0], &[0.0, 0.0]], &[&[0.0], &[1e200]], &[&[1.0, 0.0]]);
        assert_eq!(huge.unreachable_mode(), None);
    }

    #[test]
    fn what_no_input_reaches_and_no_output_shows_is_named() {
        // A double integrator, and beside it a motion that grows and that nothing drives.
        let a: &[&[f64]] = &[&[0.0, 1.0, 0.0], &[0.0, 0.0, 0.0], &[0.0, 0.0, 2.0]];
        let lone = plant(a, &[&[0.0], &[1.0], &[0.0]], &[&[1.0, 0.0, 0.0]]);
        for mode in [lone.unreachable_mode(), lone.unobservable_mode()] {
            let mode = mode.unwrap();
            assert_eq!(mode.states[0].0, "x3");
            assert!((mode.growth_rate - 2.0).abs() < 1e-12, "{mode}");
        }
        // A part of 10⁻⁵ is enough to reach it, whatever the unit of the input.
        let driven = plant(a, &[&[0.0], &[1e9], &[1e4]], &[&[1.0, 0.0, 1e-5]]);
        assert_eq!(driven.unreachable_mode(), None);
        assert_eq!(driven.unobservable_mode(), None);
        // The rate alone does not show a position.
        let rate = plant(
            &a[..2].iter().map(|row| &row[..2]).collect::<Vec<_>>(),
            &[&[0.0], &[1.0]],
            &[&[0.0, 1.0]],
        );
        assert_eq!(rate.unobservable_mode().unwrap().states[0].0, "x1");
        assert_eq!(rate.unreachable_mode(), None);
    }

    #[test]
    fn one_input_does_not_reach_two_alike_motions() {
        let twins = plant(&[&[1.0, 0.0], &[0.0, 1.0]], &[&[1.0], &[1.0]], &[&[1.0, 0.0]]);
        assert!(twins.unreachable_mode().is_some() && twins.unobservable_mode().is_some());
    }

    #[test]
    fn modes_have_growth_frequency_and_shape() {
        let damped = plant(&[&[0.0, 1.0], &[-25.0, -2.0]], &[&[0.0], &[1.0]], &[&[1.0, 0.0]]);
        let [mode] = &damped.modes()[..] else { panic!("one pair") };
        assert!((mode.growth_rate + 1.0).abs() < 1e-12, "{mode}");
        assert!((mode.frequency - 24.0_f64.sqrt() / TAU).abs() < 1e-12, "{mode}");
        // v is 5 times q.
        assert_eq!(mode.states[0].0, "x2");
        assert!((mode.states[1].1 - 0.2).abs() < 1e-12);
    }
}
