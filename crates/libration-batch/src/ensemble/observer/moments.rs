//! Means and variances over trajectories.

use libration_core::{Float, State};

use super::{Lanes, Observer};

/// Keeps the mean and the variance of every coordinate over the trajectories, at every step that it
/// sees; those of all observers of an ensemble are [merged](Moments::merged).
#[derive(Clone, Debug, Default)]
pub struct Moments<const D: usize> {
    steps: Vec<(u64, [Running; D], [Running; D])>,
    /// The place among `steps` that the block at hand has reached.
    next: usize,
    /// The first trajectory of that block.
    block: Option<usize>,
}

/// Mean and variance of numbers that come one by one (B. P. Welford, Technometrics 4, 1962).
#[derive(Clone, Copy, Debug, PartialEq)]
struct Running {
    count: u64,
    mean: f64,
    /// Sum of squares of the distances from the mean.
    squares: f64,
}

impl Running {
    const NONE: Running = Running { count: 0, mean: 0.0, squares: 0.0 };

    fn add(&mut self, x: f64) {
        self.count += 1;
        let apart = x - self.mean;
        self.mean += apart / self.count as f64;
        self.squares += apart * (x - self.mean);
    }

    /// Merges two sets of moments (T. F. Chan, G. H. Golub, R. J. LeVeque, Compstat 1982).
    fn merge(self, other: Running) -> Running {
        if self.count == 0 {
            return other;
        }
        let count = self.count + other.count;
        let apart = other.mean - self.mean;
        let share = other.count as f64 / count as f64;
        Running {
            count,
            mean: self.mean + apart * share,
            squares: self.squares + other.squares + apart * apart * self.count as f64 * share,
        }
    }

    /// The mean square distance from the mean.
    fn variance(self) -> f64 {
        self.squares / self.count as f64
    }
}

/// The statistics of one step in [`Moments`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary<const D: usize> {
    /// Number of steps taken.
    pub step: u64,
    /// Number of trajectories.
    pub count: u64,
    /// The mean state.
    pub mean: State<f64, D>,
    /// The variance of each coordinate: the mean square distance from its mean.
    pub variance: State<f64, D>,
}

impl<const D: usize> Moments<D> {
    /// Moments without samples.
    pub fn new() -> Self {
        Moments { steps: Vec::new(), next: 0, block: None }
    }

    /// Merges `parts`, in their order.
    pub fn merged(parts: impl IntoIterator<Item = Moments<D>>) -> Moments<D> {
        let mut parts = parts.into_iter();
        let mut all = parts.next().unwrap_or_default();
        for part in parts {
            for (own, other) in all.steps.iter_mut().zip(part.steps) {
                for i in 0..D {
                    own.1[i] = own.1[i].merge(other.1[i]);
                    own.2[i] = own.2[i].merge(other.2[i]);
                }
            }
        }
        all
    }

    /// The summary of each observed step.
    pub fn summaries(&self) -> impl Iterator<Item = Summary<D>> + '_ {
        self.steps.iter().map(|(step, q, v)| Summary {
            step: *step,
            count: q.first().map_or(0, |running| running.count),
            mean: State { q: q.map(|x| x.mean), v: v.map(|x| x.mean) },
            variance: State { q: q.map(Running::variance), v: v.map(Running::variance) },
        })
    }
}

impl<T: Float, const D: usize> Observer<T, D> for Moments<D> {
    fn observe(&mut self, lanes: &Lanes<'_, T, D>) {
        // Each block goes through the same steps as the first.
        if self.block != Some(lanes.first) {
            (self.block, self.next) = (Some(lanes.first), 0);
        }
        if self.next == self.steps.len() {
            self.steps.push((lanes.step, [Running::NONE; D], [Running::NONE; D]));
        }
        let (_, q, v) = &mut self.steps[self.next];
        self.next += 1;
        // One by one: the order does not depend on where blocks begin.
        for l in 0..lanes.len() {
            for i in 0..D {
                q[i].add(lanes.q[i][l].to_f64());
                v[i].add(lanes.v[i][l].to_f64());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(numbers: &[f64]) -> Running {
        let mut running = Running::NONE;
        numbers.iter().for_each(|&x| running.add(x));
        running
    }

    #[test]
    fn mean_and_variance_are_those_of_the_definition() {
        let running = of(&[2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0]);
        assert_eq!((running.mean, running.variance()), (5.0, 4.0));
    }

    #[test]
    fn parts_merge_to_the_whole() {
        let merged = of(&[2.0, 4.0, 4.0]).merge(of(&[4.0, 5.0, 5.0, 7.0, 9.0]));
        // Ten roundings of numbers below 40.
        assert!((merged.mean - 5.0).abs() < 1e-14 && (merged.variance() - 4.0).abs() < 1e-14);
        assert_eq!(Running::NONE.merge(of(&[1.0, 2.0])), of(&[1.0, 2.0]));
    }
}
