//! A step of a loop under noise, and its cost.

use libration_core::Scalar;
use libration_core::control::{Latency, LqrWeights};
use libration_core::number::Wide;

use super::augmented_state::AugmentedState;
use super::dense_matrix::{Matrix, symmetric_square};
use super::{LinearController, Plant};

/// One possible step of a loop, with its probability.
pub(super) struct Stage {
    pub(super) weight: f64,
    /// The matrix on the augmented state.
    pub(super) step: Matrix,
    /// The covariance of what noise adds to position and velocity.
    pub(super) noise: [[f64; 2]; 2],
    /// The cost as a quadratic form of the augmented state at the beginning of the step.
    pub(super) cost: Matrix,
    /// The constant part of the cost.
    pub(super) constant: f64,
    /// The length by which the cost is divided: seconds, or 1 per step.
    pub(super) length: f64,
}

impl Stage {
    /// The expected cost for these second moments at the beginning of the step.
    pub(super) fn expected(&self, moments: &Matrix) -> f64 {
        let rows = self.cost.iter().zip(moments);
        let form: f64 = rows.flat_map(|(a, b)| a.iter().zip(b)).map(|(a, b)| a * b).sum();
        form + self.constant
    }
}

/// The options of a stage.
#[derive(Clone, Copy)]
pub(super) struct StageOptions<'a> {
    pub(super) waiting: AugmentedState,
    pub(super) controller: &'a LinearController,
    pub(super) latency: Latency,
    /// The weights of the cost, if it is computed.
    pub(super) weights: Option<LqrWeights>,
}

impl Plant<'_> {
    /// A step of `h` seconds in which the command arrives, or is lost.
    pub(super) fn stage(
        &self,
        options: StageOptions<'_>,
        weight: f64,
        h: Wide,
        lost: bool,
    ) -> Stage {
        let StageOptions { waiting, controller, latency, weights } = options;
        let split = self.split_in_floats(latency.part(), h);
        let d = (!lost).then_some(latency.whole() as usize);
        let step = waiting.step(&split, controller, d);
        let n = waiting.size();
        let mut cost = vec![vec![0.0; n]; n];
        let Some(weights) = weights else {
            let noise = [[0.0; 2]; 2];
            return Stage { weight, step, noise, cost, constant: 0.0, length: 1.0 };
        };
        let (held, arriving) = (waiting.held(), waiting.arriving(controller, d));
        let coordinate = |i: usize| {
            let mut row = vec![0.0; n];
            row[i] = 1.0;
            row
        };
        let part = latency.part();
        let seconds = h.to_f64();
        if !self.exact {
            // The state at its beginning stands for the step, each command for its part.
            let LqrWeights { position, velocity, command } = weights;
            add_square(&mut cost, position, &coordinate(0));
            add_square(&mut cost, velocity, &coordinate(1));
            add_square(&mut cost, command * part, &held);
            add_square(&mut cost, command * (1.0 - part), &arriving);
            let gain = [0, 1].map(|i| split.old[i] + split.new[i]);
            let noise = Plant::held_noise(gain, seconds);
            return Stage { weight, step, noise, cost, constant: 0.0, length: 1.0 };
        }
        let before = self.whole(h * Wide::from_f64(part));
        let moved: [Vec<f64>; 2] = core::array::from_fn(|i| {
            let mut row: Vec<f64> = held.iter().map(|x| before.gamma[i] * x).collect();
            (0..2).for_each(|j| row[j] += before.phi[i][j]);
            row
        });
        let [q, v] = moved;
        let first = self.step_integrals(weights, seconds * part).cost;
        let second = self.step_integrals(weights, seconds * (1.0 - part)).cost;
        add_form(&mut cost, first, [&coordinate(0), &coordinate(1), &held]);
        add_form(&mut cost, second, [&q, &v, &arriving]);
        let whole = self.step_integrals(weights, seconds);
        Stage { weight, step, noise: whole.noise, cost, constant: whole.constant, length: seconds }
    }
}

/// `E[M ⊗ M]` on symmetric matrices.
pub(super) fn mean_square(stages: &[Stage]) -> Matrix {
    let mut mean: Matrix = Vec::new();
    for stage in stages {
        let square = symmetric_square(&stage.step);
        mean.resize(square.len(), vec![0.0; square.len()]);
        for (row, square) in mean.iter_mut().zip(square) {
            row.iter_mut().zip(square).for_each(|(sum, x)| *sum += stage.weight * x);
        }
    }
    mean
}

/// Adds `weight·(row·x)²`.
fn add_square(form: &mut Matrix, weight: f64, row: &[f64]) {
    add_product(form, weight, row, row);
}

/// Adds `weight·(a·x)(b·x)`.
fn add_product(form: &mut Matrix, weight: f64, a: &[f64], b: &[f64]) {
    for (row, a) in form.iter_mut().zip(a) {
        row.iter_mut().zip(b).for_each(|(x, b)| *x += weight * a * b);
    }
}

/// Adds a form of three linear functions.
fn add_form(form: &mut Matrix, entries: [[f64; 3]; 3], rows: [&[f64]; 3]) {
    for (entries, a) in entries.into_iter().zip(rows) {
        for (entry, b) in entries.into_iter().zip(rows) {
            add_product(form, entry, a, b);
        }
    }
}
