//! The system in continuous time that a step approximates: the limit of small steps.

use libration::linear::{Matrix, eigenvalues, logarithm};

use crate::BlackBoxError;
use crate::linearised_step::LinearisedStep;
use crate::prober::Prober;

/// Halvings of the step that are tried until it is short beside all motions.
const MOST_HALVINGS: usize = 40;
/// Steps from which the limit is extrapolated, each half of the one before.
const LEVELS: usize = 5;
/// Halvings beyond the last level at which the limit is confirmed, and most of those that are tried until it is.
const FARTHER: usize = 6;
const MORE_HALVINGS: usize = 14;
/// Factor by which a rate may be farther from the limit than one that converges with order 1, estimated errors that count, and the part
/// of the largest rate that is no difference.
const MARGIN: f64 = 4.0;
const ERRORS: f64 = 10.0;
const NEAR: f64 = 1e-6;
/// Distance of all factors of a short step from 1.
const SHORT: f64 = 0.2;

/// The rates of small deviations, `ẋ = A x + B u`.
#[derive(Clone, Debug)]
pub(crate) struct Flow {
    /// States × states, in 1/s.
    pub(crate) a: Matrix,
    /// States × inputs.
    pub(crate) b: Matrix,
    /// Estimated absolute errors of `a`.
    pub(crate) a_errors: Matrix,
    /// Matrices of the steps of falling length, from that of the subject.
    pub(crate) steps: Vec<LinearisedStep>,
}

impl Flow {
    /// The limit of `log(A(h))/h` for small steps `h`, by Richardson's extrapolation; none where the matrices have no logarithm or
    /// the length of the step has no effect.
    pub(crate) fn of(
        prober: &mut Prober<'_>,
        step: &LinearisedStep,
    ) -> Result<Option<Self>, BlackBoxError> {
        let mut steps = vec![step.clone()];
        let mut levels: Vec<(Matrix, Matrix)> = Vec::new();
        let mut first: Option<((Matrix, Matrix), usize)> = None;
        let subject = prober.subject;
        for halvings in 0..MOST_HALVINGS {
            let step = match steps.get(halvings) {
                Some(step) => step,
                None => {
                    let dt = subject.dt * 2.0_f64.powi(-(halvings as i32));
                    steps.push(LinearisedStep::at(prober, dt)?);
                    &steps[halvings]
                }
            };
            if !step.is_finite() {
                return Ok(None);
            }
            match rates(step) {
                Some(level) => levels.push(level),
                // A longer step may be short where this one is not, if its matrix is close to the identity by chance.
                None => levels.clear(),
            }
            if levels.len() == LEVELS {
                let limit = extrapolate(&levels);
                let is_last = first.as_ref().is_some_and(|(_, at)| halvings - at == MORE_HALVINGS);
                if is_confirmed(prober, &limit, &levels, halvings)? {
                    return Ok(Some(Flow::new(limit, steps)));
                }
                let (unconfirmed, _) = first.get_or_insert((limit, halvings));
                if is_last {
                    return Ok(Some(Flow::new(unconfirmed.clone(), steps)));
                }
                // Steps that are not shorter than an inner one seem to converge, to the rates of inner steps.
                levels.remove(0);
            }
        }
        Ok(first.map(|(limit, _)| Flow::new(limit, steps)))
    }

    fn new((whole, errors): (Matrix, Matrix), steps: Vec<LinearisedStep>) -> Self {
        let (n, m) = (steps[0].a.rows(), steps[0].b.columns());
        Flow {
            a: whole.block((0, 0), (n, n)),
            b: whole.block((0, n), (n, m)),
            a_errors: errors.block((0, 0), (n, n)),
            steps,
        }
    }

    /// The rates with entries of 0 and 1 where they are so within their errors.
    pub(crate) fn cleaned(&self) -> Matrix {
        Matrix::from_fn(self.a.rows(), self.a.columns(), |i, j| {
            let value = self.a[(i, j)];
            let error = 10.0 * self.a_errors[(i, j)] + 1e-9;
            let near = |target: f64| (value - target).abs() <= error;
            if near(0.0) {
                0.0
            } else if near(1.0) {
                1.0
            } else {
                value
            }
        })
    }
}

/// Whether the rates of a far shorter step are as near to the limit as those of the last level tell.
fn is_confirmed(
    prober: &mut Prober<'_>,
    (limit, errors): &(Matrix, Matrix),
    levels: &[(Matrix, Matrix)],
    halvings: usize,
) -> Result<bool, BlackBoxError> {
    // With a memory in time, far shorter steps need as many more calls.
    if prober.memory > 0 {
        return Ok(true);
    }
    let dt = prober.subject.dt * 2.0_f64.powi(-((halvings + FARTHER) as i32));
    let Some((rates, own_errors)) = rates(&LinearisedStep::at(prober, dt)?) else {
        return Ok(false);
    };
    let last = &levels[LEVELS - 1].0;
    let largest = limit.entries().iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let is_near = |k: usize| {
        let of = |matrix: &Matrix| matrix.entries()[k];
        let falls = MARGIN * (of(last) - of(limit)).abs() / f64::from(1 << FARTHER);
        let explained = ERRORS * (of(&own_errors) + of(errors)) + NEAR * largest;
        (of(&rates) - of(limit)).abs() <= falls + explained
    };
    Ok((0..limit.entries().len()).all(is_near))
}

/// The rates whose exact flow a short step is, and their errors.
fn rates(step: &LinearisedStep) -> Option<(Matrix, Matrix)> {
    let whole = step.augmented();
    let size = whole.rows();
    let n = step.a.rows();
    if eigenvalues(&step.a)?.iter().any(|z| (z - 1.0).norm() > SHORT) {
        return None;
    }
    let rates = logarithm(&whole)?.scaled(step.dt.recip());
    let mut errors = Matrix::zeros(size, size);
    errors.set_block((0, 0), &step.a_errors.scaled(step.dt.recip()));
    errors.set_block((0, n), &step.b_errors.scaled(step.dt.recip()));
    Some((rates, errors))
}

/// The limit of levels at `h, h/2, …`, each entry that of the smallest estimated error.
fn extrapolate(levels: &[(Matrix, Matrix)]) -> (Matrix, Matrix) {
    let (rows, columns) = (levels[0].0.rows(), levels[0].0.columns());
    let (mut limit, mut errors) = (Matrix::zeros(rows, columns), Matrix::zeros(rows, columns));
    for i in 0..rows {
        for j in 0..columns {
            let entries: Vec<(f64, f64)> =
                levels.iter().map(|(rates, errors)| (rates[(i, j)], errors[(i, j)])).collect();
            (limit[(i, j)], errors[(i, j)]) = limit_of_halved(&entries);
        }
    }
    (limit, errors)
}

/// The limit of values at `h, h/2, …` with these errors, whose distance from the limit has all powers of `h`, and its estimated error.
pub(crate) fn limit_of_halved(values: &[(f64, f64)]) -> (f64, f64) {
    let mut before: Vec<f64> = Vec::new();
    let mut best = (values.last().map_or(f64::NAN, |last| last.0), f64::INFINITY);
    for &(value, rounding) in values {
        let mut row = vec![value];
        for (order, old) in before.iter().enumerate() {
            let last = row[order];
            let next = last + (last - old) / (2.0_f64.powi(order as i32 + 1) - 1.0);
            // Extrapolation multiplies rounding by at most 8.3, the product of (2ʲ + 1)/(2ʲ − 1).
            let error = (next - last).abs().min((next - old).abs()) + 8.3 * rounding;
            if error <= best.1 {
                best = (next, error);
            }
            row.push(next);
        }
        before = row;
    }
    best
}
