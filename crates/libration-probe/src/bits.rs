//! Whether a step gives the same bits again: twice in a row, after a restart, and in batches of any size.

use libration::linear::Matrix;
use serde::Serialize;

use crate::prober::{Prober, row};
use crate::{BlackBoxError, FirstDifference, Recording};

/// Sizes of batches.
const BATCHES: [usize; 3] = [1, 7, 4096];
/// Roundings that single precision leaves in a step, relative to its results: a few of 6·10⁻⁸, or a part of one.
const SINGLE: core::ops::Range<f64> = 3e-10..1e-6;
/// Points of a line whose differences show rounding.
const CLOSE: usize = 24;
/// Calls with the same values, from which randomness shows.
const REPETITIONS: usize = 8;

/// Results of the checks of bits.
#[derive(Clone, Debug, Serialize)]
pub struct Bits {
    /// The checks, in the order in which they were made.
    pub checks: Vec<BitCheck>,
    /// Whether results vary at random, and how.
    pub randomness: Option<Randomness>,
    /// The rounding of results relative to their size; that of `f64` is 2·10⁻¹⁶.
    pub rounding: f64,
    /// Whether the step computes in single precision.
    pub single_precision: bool,
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
        let entries = first.entries();
        let is_single = |x: f64| f64::from(x as f32).to_bits() == x.to_bits();
        let single_precision = entries.iter().all(|&x| is_single(x));
        let rounding = if is_random { f64::NAN } else { noise_along_a_line(prober, -20)? };
        // Rounding does not fall with the distance as the bend of a smooth function does. Much closer points are the same number in single
        // precision, where a rough function is as rough.
        let is_coarse = SINGLE.contains(&rounding)
            && noise_along_a_line(prober, -22)? > rounding / 10.0
            && noise_along_a_line(prober, -40)? < SINGLE.start / 10.0;
        let single_precision = single_precision || is_coarse;
        Ok(Bits { checks, randomness, rounding, single_precision })
    }
}

/// The rounding of a step relative to its results: the fourth differences along a line of points, over the root of the sum of their
/// squared coefficients.
///
/// At `2⁻²⁰` of the scales the points are so far apart that single precision parts them, and so close that a smooth function has no fourth
/// difference.
fn noise_along_a_line(prober: &mut Prober<'_>, exponent: i32) -> Result<f64, BlackBoxError> {
    let subject = prober.subject;
    let (x, scale) = (&subject.state, &subject.state_scale);
    let n = x.len();
    let states = Matrix::from_fn(CLOSE, n, |k, i| {
        let step = (k as f64 + 0.3) * 2.0_f64.powi(exponent);
        x[i] + scale[i] * (step + 0.013 * (1.0 + i as f64 / 7.0))
    });
    let actions = Matrix::from_fn(CLOSE, subject.action.len(), |_, j| subject.action[j]);
    let next = prober.step(&states, &actions, subject.dt)?;
    let fourth = |k: usize, i: usize| {
        [1.0, -4.0, 6.0, -4.0, 1.0].iter().zip(k..).map(|(c, k)| c * next[(k, i)]).sum::<f64>()
    };
    let size = |i: usize| next[(0, i)].abs().max(0.01 * scale[i]);
    let largest = |i: usize| (0..CLOSE - 4).map(|k| fourth(k, i).abs()).fold(0.0, f64::max);
    Ok((0..n).map(|i| largest(i) / 70.0_f64.sqrt() / size(i)).fold(0.0, f64::max))
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
