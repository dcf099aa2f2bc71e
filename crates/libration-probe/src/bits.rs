//! Whether a step gives the same bits again: twice in a row, after a restart, and in batches of any size.

use libration::linear::Matrix;
use serde::Serialize;

use crate::prober::{Prober, row};
use crate::{BlackBoxError, FirstDifference, Recording, Rounding};

/// Sizes of batches.
const BATCHES: [usize; 3] = [1, 7, 4096];
/// Calls with the same values, from which randomness shows.
const REPETITIONS: usize = 8;

/// Results of the checks of bits.
#[derive(Clone, Debug, Serialize)]
pub struct Bits {
    /// The checks, in the order in which they were made.
    pub checks: Vec<BitCheck>,
    /// Whether results vary at random, and how.
    pub randomness: Option<Randomness>,
    /// Roundings of the step; none if results vary at random.
    pub rounding: Option<Rounding>,
}

/// A comparison of the bits of two results that should be the same.
#[derive(Clone, Debug, Serialize)]
pub struct BitCheck {
    /// The comparison in words.
    pub name: String,
    /// The first difference, by call, environment and component; none if all bits agree.
    pub difference: Option<FirstDifference>,
}

/// How results vary that should be the same.
#[derive(Clone, Debug, Serialize)]
pub struct Randomness {
    /// The standard deviation of each state over calls with the same values.
    pub deviations: Vec<f64>,
    /// Whether environments of a batch with the same state and action get different results; none without batches.
    pub environments_differ: Option<bool>,
    /// Whether the results of the first environment depend on the number of environments beside it, after a restart; none if unknown.
    pub generator_is_shared: Option<bool>,
}

impl Bits {
    /// Calls the same steps again and again.
    pub(crate) fn check(prober: &mut Prober<'_>) -> Result<Self, BlackBoxError> {
        let points = points(prober, BATCHES[1]);
        let mut checks = Vec::new();
        // Earlier calls differ, so that a memory would show as a difference: it is flushed.
        let first = prober.step(&points.0, &points.1, prober.subject.dt)?;
        let second = prober.step(&points.0, &points.1, prober.subject.dt)?;
        checks.push(BitCheck::new("the same call twice", &first, &second));
        if prober.is_batched() {
            for count in BATCHES {
                checks.push(batch_check(prober, &points, &first, count)?);
            }
        }
        if prober.restart()? {
            let again = prober.step(&points.0, &points.1, prober.subject.dt)?;
            checks.push(BitCheck::new("after a restart", &first, &again));
        }
        for recording in &prober.subject.recordings {
            let Recording { name, shape, first, second } = recording;
            let difference = FirstDifference::find(first, second, shape);
            checks.push(BitCheck { name: name.clone(), difference });
        }
        let is_random = checks[0].difference.is_some();
        let randomness = if is_random { Some(Randomness::measure(prober)?) } else { None };
        let rounding = if is_random { None } else { Some(Rounding::measure(prober, &first)?) };
        Ok(Bits { checks, randomness, rounding })
    }
}

impl BitCheck {
    fn new(name: &str, first: &Matrix, second: &Matrix) -> Self {
        let shape = [first.rows(), first.columns()];
        let difference = FirstDifference::find(first.entries(), second.entries(), &shape);
        BitCheck { name: name.to_owned(), difference }
    }
}

/// States and actions around those of the subject, none of which is a number of single precision.
fn points(prober: &Prober<'_>, count: usize) -> (Matrix, Matrix) {
    let subject = prober.subject;
    let near = |values: &[f64], scale: &[f64], amplitude: f64| {
        Matrix::from_fn(count, values.len(), |i, j| {
            let turn = ((i * values.len() + j) as f64).mul_add(0.618_033_988_749_894_9, 0.1);
            values[j] + amplitude * scale[j] * (turn.fract() - 0.5)
        })
    };
    let states = near(&subject.state, &subject.state_scale, 1.0 / 32.0);
    (states, near(&subject.action, &subject.action_scale, 1.0 / 32.0))
}

/// Compares a batch of `count` environments, of which the first are the points, with the results of the points.
fn batch_check(
    prober: &mut Prober<'_>,
    (states, actions): &(Matrix, Matrix),
    alone: &Matrix,
    count: usize,
) -> Result<BitCheck, BlackBoxError> {
    let repeat = |matrix: &Matrix| {
        Matrix::from_fn(count, matrix.columns(), |i, j| matrix[(i % matrix.rows(), j)])
    };
    let next = prober.step(&repeat(states), &repeat(actions), prober.subject.dt)?;
    let expected = repeat(alone);
    let name = format!("a batch of {count} against one of {}", states.rows());
    Ok(BitCheck::new(&name, &expected, &next))
}

impl Randomness {
    fn measure(prober: &mut Prober<'_>) -> Result<Self, BlackBoxError> {
        let subject = prober.subject;
        let (x, u, dt) = (&subject.state, &subject.action, subject.dt);
        let runs: Vec<Vec<f64>> =
            (0..REPETITIONS).map(|_| prober.call_one(x, u, dt)).collect::<Result<_, _>>()?;
        let deviations = (0..x.len()).map(|i| deviation(runs.iter().map(|run| run[i]))).collect();
        let (mut environments_differ, mut generator_is_shared) = (None, None);
        if prober.is_batched() {
            let copies =
                |values: &[f64], count| Matrix::from_fn(count, values.len(), |_, j| values[j]);
            let next = prober.call(&copies(x, REPETITIONS), &copies(u, REPETITIONS), dt)?;
            let differ = (1..next.rows()).any(|i| next.row(i) != next.row(0));
            environments_differ = Some(differ);
            if prober.restart()? {
                // Two calls each: the second shows how many numbers the first one has drawn.
                let second = |prober: &mut Prober<'_>, count| {
                    prober.call(&copies(x, count), &copies(u, count), dt)?;
                    let next = prober.call(&copies(x, count), &copies(u, count), dt)?;
                    Ok::<_, BlackBoxError>(row(next.row(0)))
                };
                let few = second(prober, 1)?;
                prober.restart()?;
                generator_is_shared = Some(second(prober, REPETITIONS)? != few);
            }
        }
        Ok(Randomness { deviations, environments_differ, generator_is_shared })
    }
}

fn deviation(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let count = values.clone().count() as f64;
    let mean = values.clone().sum::<f64>() / count;
    let square: f64 = values.map(|x| (x - mean) * (x - mean)).sum();
    (square / (count - 1.0)).sqrt()
}
