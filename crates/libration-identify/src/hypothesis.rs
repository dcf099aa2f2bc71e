//! Hypotheses about the command that acts.

use crate::plant_step::PlantStep;
use crate::response::UnitPlant;

/// Most states of a plant whose arrivals are filtered.
pub(crate) const MOST_STATES: usize = 3;

/// Most hypotheses at a time.
const MOST_HYPOTHESES: usize = 10;

/// Hypotheses are merged if their means differ by less than the root of this part of the sum of their variances.
const ALIKE: f64 = 0.1;

/// The least weight of a hypothesis relative to the heaviest.
const LIGHTEST: f64 = 1e-6;

/// How commands arrive and what answers them.
#[derive(Clone, Debug)]
pub(crate) struct ArrivalModel {
    /// Parameters of the response, the dead time first.
    pub(crate) shape: Vec<f64>,
    pub(crate) gain: f64,
    pub(crate) load: f64,
    /// Standard deviation of the noise.
    pub(crate) deviation: f64,
    /// The standard deviation of its dead time, in s.
    pub(crate) jitter: f64,
    /// The probability that a command is lost.
    pub(crate) loss: f64,
    /// What a longer dead time adds, in s, and the share of commands that it delays.
    pub(crate) second: (f64, f64),
}

/// A command that may act, its probability, and the state of the plant if it does.
pub(crate) type State = [f64; MOST_STATES];

#[derive(Clone, Copy, Debug)]
pub(crate) struct Hypothesis {
    pub(crate) acting: usize,
    pub(crate) weight: f64,
    pub(crate) mean: State,
    pub(crate) covariance: [State; MOST_STATES],
}

impl Hypothesis {
    /// Takes a response; its error and the variance of that error.
    pub(crate) fn measure(
        &mut self,
        plant: &UnitPlant,
        model: &ArrivalModel,
        values: &[f64],
        response: f64,
    ) -> (f64, f64) {
        let n = plant.states();
        let mut predicted = plant.d * (model.gain * values[self.acting] + model.load);
        let mut spread = model.deviation * model.deviation;
        let mut gains = [0.0; MOST_STATES];
        for (i, gain) in gains.iter_mut().enumerate().take(n) {
            predicted += plant.c[i] * self.mean[i];
            *gain = (0..n).map(|j| self.covariance[i][j] * plant.c[j]).sum();
            spread += plant.c[i] * *gain;
        }
        let error = response - predicted;
        for i in 0..n {
            self.mean[i] += gains[i] / spread * error;
            for j in 0..n {
                self.covariance[i][j] -= gains[i] * gains[j] / spread;
            }
        }
        (error, spread)
    }

    /// Moves on by a step under its command.
    pub(crate) fn advance(&mut self, step: &PlantStep, values: &[f64], model: &ArrivalModel) {
        let n = step.gamma.len();
        let command = model.gain * values[self.acting] + model.load;
        let phi = |i: usize, j: usize| step.phi[i * n + j];
        let sum = |term: &dyn Fn(usize) -> f64| (0..n).map(term).sum::<f64>();
        let mut mean = [0.0; MOST_STATES];
        let mut half = [[0.0; MOST_STATES]; MOST_STATES];
        for (i, row) in half.iter_mut().enumerate().take(n) {
            mean[i] = step.gamma[i] * command + sum(&|k| phi(i, k) * self.mean[k]);
            for (j, entry) in row.iter_mut().enumerate().take(n) {
                *entry = sum(&|k| phi(i, k) * self.covariance[k][j]);
            }
        }
        for (i, row) in half.iter().enumerate().take(n) {
            for j in 0..n {
                self.covariance[i][j] = sum(&|k| row[k] * phi(j, k));
            }
        }
        self.mean = mean;
    }

    /// The arrival of a change is spread over time: a shift by `δ` is an impulse of `−δ` times the change at the input.
    pub(crate) fn shift(&mut self, plant: &UnitPlant, impulse: f64) {
        for i in 0..plant.states() {
            for j in 0..plant.states() {
                self.covariance[i][j] += impulse * impulse * plant.b[i] * plant.b[j];
            }
        }
    }

    /// Whether both have the same acting command and nearly the same state.
    pub(crate) fn is_like(&self, other: &Hypothesis) -> bool {
        let is_near = |i: usize| {
            let variance = self.covariance[i][i] + other.covariance[i][i];
            (self.mean[i] - other.mean[i]).powi(2) <= ALIKE * variance
        };
        self.acting == other.acting && (0..MOST_STATES).all(is_near)
    }

    /// This hypothesis and another as one, with their mean and covariance.
    pub(crate) fn merged(self, other: Hypothesis) -> Hypothesis {
        let weight = self.weight + other.weight;
        if weight <= 0.0 || weight.is_nan() {
            return self;
        }
        let (own, others) = (self.weight / weight, other.weight / weight);
        let mut merged = Hypothesis { weight, ..self };
        for i in 0..MOST_STATES {
            merged.mean[i] = own * self.mean[i] + others * other.mean[i];
            for j in 0..MOST_STATES {
                let between = (self.mean[i] - other.mean[i]) * (self.mean[j] - other.mean[j]);
                merged.covariance[i][j] = own * self.covariance[i][j]
                    + others * other.covariance[i][j]
                    + own * others * between;
            }
        }
        merged
    }
}

/// Merges hypotheses with the same acting command whose means differ by less than their deviations.
///
/// Those with different means stay apart: together they would be a normal law far wider than either, and the next response could no longer
/// choose between them.
pub(crate) fn merge_alike(hypotheses: &mut Vec<Hypothesis>) {
    let mut i = 0;
    while i < hypotheses.len() {
        let mut j = i + 1;
        while j < hypotheses.len() {
            if hypotheses[i].is_like(&hypotheses[j]) {
                let other = hypotheses.swap_remove(j);
                hypotheses[i] = hypotheses[i].merged(other);
            } else {
                j += 1;
            }
        }
        i += 1;
    }
    if hypotheses.len() > MOST_HYPOTHESES {
        prune(hypotheses);
    }
}

/// Drops hypotheses that weigh nothing.
pub(crate) fn prune(hypotheses: &mut Vec<Hypothesis>) {
    hypotheses.sort_by(|a, b| b.weight.total_cmp(&a.weight));
    let heaviest = hypotheses[0].weight;
    hypotheses.retain(|h| h.weight >= LIGHTEST * heaviest);
    hypotheses.truncate(MOST_HYPOTHESES);
}
