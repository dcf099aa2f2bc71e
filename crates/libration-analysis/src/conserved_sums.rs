//! Weighted sums of states that a system conserves.

use libration_equations::Dynamics;
use libration_linear::{Matrix, SingularValues};

/// The largest number of states that are searched.
const MOST_STATES: usize = 40;

/// The part of the largest singular value of rates below which one is rounding.
const ROUNDING: f64 = 1e-12;

/// Weights below this part of the largest are zero.
const NOTHING: f64 = 1e-9;

/// A weighted sum of states that no motion changes, such as a total mass or momentum.
#[derive(Clone, Debug, PartialEq)]
pub struct ConservedSum {
    /// Places of states among positions and velocities, with their weights. The first is 1.
    pub weights: Vec<(usize, f64)>,
    /// Its value at the start.
    pub start: f64,
}

impl ConservedSum {
    /// The weight of the state at a place.
    pub fn weight(&self, place: usize) -> f64 {
        self.weights.iter().find(|(own, _)| *own == place).map_or(0.0, |(_, weight)| *weight)
    }

    /// The value at a state: positions and velocities.
    pub fn at(&self, state: &[f64]) -> f64 {
        self.weights.iter().map(|&(place, weight)| weight * state[place]).sum()
    }

    /// Whether the value at a state is that of the start, to rounding.
    pub fn holds_at(&self, state: &[f64]) -> bool {
        let sizes = self.weights.iter().map(|&(place, weight)| (weight * state[place]).abs());
        let size = sizes.sum::<f64>().max(self.start.abs());
        (self.at(state) - self.start).abs() <= 1e-6 * size
    }
}

/// Sums of states that are conserved.
pub type ConservedSums = [ConservedSum];

/// The weighted sums of the states at `places` that a system conserves from `start`: positions, velocities and inputs.
///
/// They are what is orthogonal to the rates at states around the start; a sum that is conserved only on some motions is none. Empty for
/// systems of more than 40 states, and where rates are not defined around the start.
pub fn conserved_sums(dynamics: &Dynamics, start: &[f64], places: &[usize]) -> Vec<ConservedSum> {
    let (n, d) = (places.len(), dynamics.degrees());
    if n == 0 || n > MOST_STATES {
        return Vec::new();
    }
    let mut accelerations = dynamics.accelerations().on::<f64>();
    let mut rates_at = |state: &[f64]| -> Vec<f64> {
        let all: Vec<f64> = accelerations.run(state).collect();
        let rate = |&place: &usize| if place < d { state[place + d] } else { all[place - d] };
        places.iter().map(rate).collect()
    };
    let mut samples: Vec<Vec<f64>> = Vec::new();
    for number in 0..4 * n + 16 {
        let mut state = start.to_vec();
        // Nearer ones too, where functions are defined as they are at the start.
        let spread = [1.0, 0.1, 0.01][number % 3];
        for (k, &place) in places.iter().enumerate() {
            let part = 0.618_033_988_749_895 * (1.0 + (number * n + k) as f64);
            state[place] += spread * (part.fract() - 0.5) * start[place].abs().max(1.0);
        }
        let rates = rates_at(&state);
        if rates.iter().all(|rate| rate.is_finite()) {
            samples.push(rates);
        }
    }
    if samples.len() < n + 4 {
        return Vec::new();
    }
    let most = |j: usize| samples.iter().map(|rates| rates[j].abs()).fold(0.0, f64::max);
    let sizes: Vec<f64> = (0..n).map(most).map(|x| if x > 0.0 { x } else { 1.0 }).collect();
    let table = Matrix::from_fn(samples.len(), n, |i, j| samples[i][j] / sizes[j]);
    let Some(values) = SingularValues::of(&table) else { return Vec::new() };
    let rank = values.rank(ROUNDING);
    let rows = Matrix::from_fn(n - rank, n, |k, j| values.right[(j, rank + k)] / sizes[j]);
    let sum_of = |row: Vec<f64>| {
        let weights: Vec<(usize, f64)> =
            places.iter().copied().zip(row).filter(|(_, weight)| *weight != 0.0).collect();
        let start = weights.iter().map(|&(place, weight)| weight * start[place]).sum();
        ConservedSum { weights, start }
    };
    reduced(rows).into_iter().map(sum_of).collect()
}

/// The rows, combined so that each begins with a 1 where all others have a zero.
fn reduced(mut rows: Matrix) -> Vec<Vec<f64>> {
    let (count, n) = (rows.rows(), rows.columns());
    for i in 0..count {
        let most = rows.row(i).iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        rows.row_mut(i).iter_mut().for_each(|x| *x /= most);
    }
    let mut done = 0;
    for j in 0..n {
        let candidates = (done..count).map(|i| (rows[(i, j)].abs(), i));
        let Some((size, pivot)) = candidates.max_by(|a, b| a.0.total_cmp(&b.0)) else { break };
        if size <= NOTHING {
            continue;
        }
        let row: Vec<f64> = rows.row(pivot).iter().map(|x| x / rows[(pivot, j)]).collect();
        let moved = rows.row(done).to_vec();
        rows.row_mut(pivot).copy_from_slice(&moved);
        rows.row_mut(done).copy_from_slice(&row);
        for i in (0..count).filter(|&i| i != done) {
            let factor = rows[(i, j)];
            (0..n).for_each(|k| rows[(i, k)] -= factor * row[k]);
        }
        done += 1;
    }
    let clean = |row: &[f64]| {
        let most = row.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        // Whole numbers to rounding are whole.
        let known = |&x: &f64| match x {
            x if x.abs() <= NOTHING * most => 0.0,
            x if (x - x.round()).abs() <= NOTHING * x.abs() => x.round(),
            x => x,
        };
        row.iter().map(known).collect()
    };
    (0..done).map(|i| clean(rows.row(i))).collect()
}
