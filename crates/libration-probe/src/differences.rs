//! Jacobians by central differences, each entry with an estimate of its error.

use libration::linear::Matrix;

/// A Jacobian with estimated absolute errors of its entries.
#[derive(Clone, Debug)]
pub struct Jacobian {
    /// Values × variables.
    pub values: Matrix,
    /// Estimated absolute errors; infinite where too few points were finite.
    pub errors: Matrix,
}

/// Steps relative to the scale of a variable: 1/16, 1/64, … The first ones suit smooth functions, to rounding. The last ones suit
/// functions that bend on a thousandth of the scale.
const STEPS: usize = 11;
/// Those of searches, which need many Jacobians.
const QUICK: core::ops::Range<usize> = 5..9;
/// Further steps of variables whose derivatives have not settled, and the error relative to a row from which they have not.
const MORE_STEPS: usize = 5;
const SETTLED: f64 = 1e-5;
/// Steps that are longer than the dead zone of a solver of constraints, some 10⁻⁷ of the scale in MuJoCo.
const TRUSTED: usize = 9;
/// Errors by which estimates of longer and shorter steps may be apart.
const APART: f64 = 3.0;
/// Steps at which the slopes on both sides are compared.
const MIDDLE: core::ops::Range<usize> = 3..8;
const LEAST_STEPS: usize = 3;
/// Points so close that a function is linear between them.
const CLOSE: usize = 10;

/// The Jacobian of a function of many points at once, at `z`, with typical deviations `scale` of the variables.
///
/// Central differences of falling steps are extrapolated to zero by Richardson's scheme, and each entry is that of the smallest
/// estimated error (C. J. F. Ridders, Advances in Engineering Software 4, 1982). The estimate includes the rounding of the
/// function, by second differences at close points (J. J. Moré and S. M. Wild, SIAM Journal on Scientific Computing 33, 2011). At a
/// kink it includes half the difference of the slopes on both sides. Steps to where the function is not finite are left out. Estimates
/// of long steps that those of shorter ones contradict are none: such steps straddle a part of the function that bends. The steps
/// become shorter until the estimates settle, or their rounding grows.
///
/// `coarseness` is the rounding of values relative to them that close points do not show, such as that of single precision; else 0.
///
/// # Errors
/// Those of the function.
pub fn jacobian<E>(
    function: impl FnMut(&Matrix) -> Result<Matrix, E>,
    z: &[f64],
    scale: &[f64],
    coarseness: f64,
) -> Result<Jacobian, E> {
    jacobian_by(function, z, scale, coarseness, 0..STEPS)
}

/// The same by the short steps [`QUICK`] alone.
pub(crate) fn quick_jacobian<E>(
    function: impl FnMut(&Matrix) -> Result<Matrix, E>,
    z: &[f64],
    scale: &[f64],
) -> Result<Jacobian, E> {
    jacobian_by(function, z, scale, 0.0, QUICK)
}

fn jacobian_by<E>(
    mut function: impl FnMut(&Matrix) -> Result<Matrix, E>,
    z: &[f64],
    scale: &[f64],
    coarseness: f64,
    steps: core::ops::Range<usize>,
) -> Result<Jacobian, E> {
    let all: Vec<usize> = (0..z.len()).collect();
    let is_quick = steps == QUICK;
    let points = Points::new(z, scale, &all, steps);
    let values = function(&points.states)?;
    let centre = values.row(0);
    let mut noise = noise(&values);
    for (i, noise) in noise.iter_mut().enumerate() {
        *noise = noise.max(coarseness * (values[(0, i)]).abs());
    }
    let (rows, columns) = (values.columns(), z.len());
    let mut found =
        Jacobian { values: Matrix::zeros(rows, columns), errors: Matrix::zeros(rows, columns) };
    for j in 0..columns {
        found.set_column(j, column(centre, &noise, &points.pairs(&values, j, j)));
    }
    let unsettled = found.unsettled(scale);
    if unsettled.is_empty() || is_quick {
        return Ok(found);
    }
    let finer = Points::new(z, scale, &unsettled, STEPS..STEPS + MORE_STEPS);
    let fine = function(&finer.states)?;
    for (place, &j) in unsettled.iter().enumerate() {
        let mut pairs = points.pairs(&values, j, j);
        pairs.extend(finer.pairs(&fine, place, j));
        found.set_column(j, column(centre, &noise, &pairs));
    }
    Ok(found)
}

impl Jacobian {
    fn set_column(&mut self, j: usize, entries: Vec<(f64, f64)>) {
        for (i, (value, error)) in entries.into_iter().enumerate() {
            self.values[(i, j)] = value;
            self.errors[(i, j)] = error;
        }
    }

    /// The variables by which a derivative has a large error beside the largest one of its row.
    fn unsettled(&self, scale: &[f64]) -> Vec<usize> {
        let (rows, columns) = (self.values.rows(), self.values.columns());
        let size = |i: usize| {
            (0..columns).map(|j| (self.values[(i, j)] * scale[j]).abs()).fold(0.0, f64::max)
        };
        let sizes: Vec<f64> = (0..rows).map(size).collect();
        let is_unsettled =
            |j: &usize| (0..rows).any(|i| self.errors[(i, *j)] * scale[*j] > SETTLED * sizes[i]);
        (0..columns).filter(is_unsettled).collect()
    }
}

/// Points of a Jacobian: the centre, close points, and pairs on both sides in some of the variables.
struct Points {
    states: Matrix,
    steps: core::ops::Range<usize>,
}

impl Points {
    fn new(z: &[f64], scale: &[f64], variables: &[usize], steps: core::ops::Range<usize>) -> Self {
        let n = z.len();
        let mut rows: Vec<Vec<f64>> = vec![z.to_vec()];
        for k in 0..CLOSE {
            let shift = (k as f64 - CLOSE as f64 / 2.0) * 2.0_f64.powi(-40);
            rows.push(z.iter().zip(scale).map(|(z, scale)| z + shift * scale).collect());
        }
        for &j in variables {
            for k in steps.clone() {
                let step = scale[j] * 2.0_f64.powi(-4 - 2 * k as i32);
                for side in [step, -step] {
                    let mut point = z.to_vec();
                    point[j] += side;
                    rows.push(point);
                }
            }
        }
        Points { states: Matrix::from_fn(rows.len(), n, |i, j| rows[i][j]), steps }
    }

    /// The pairs of the variable `j`, which has this place among the variables.
    fn pairs<'a>(&self, values: &'a Matrix, place: usize, j: usize) -> Vec<Pair<'a>> {
        let first = 1 + CLOSE + 2 * place * self.steps.len();
        let pair = |(k, step)| {
            let at = first + 2 * k;
            let width = self.states[(at, j)] - self.states[(at + 1, j)];
            Pair { step, above: values.row(at), below: values.row(at + 1), width }
        };
        self.steps.clone().enumerate().map(pair).collect()
    }
}

/// The rounding of each value, including that of terms that cancel.
fn noise(values: &Matrix) -> Vec<f64> {
    let second =
        |i: usize, k: usize| values[(k, i)] - 2.0 * values[(k + 1, i)] + values[(k + 2, i)];
    let largest = |i| (1..CLOSE - 1).map(|k| second(i, k).abs()).fold(0.0, f64::max);
    (0..values.columns()).map(largest).collect()
}

struct Pair<'a> {
    step: usize,
    above: &'a [f64],
    below: &'a [f64],
    width: f64,
}

impl Pair<'_> {
    fn is_finite(&self) -> bool {
        self.above.iter().chain(self.below).all(|x| x.is_finite())
    }
}

/// Value and error of each entry of a column.
fn column(centre: &[f64], noise: &[f64], pairs: &[Pair<'_>]) -> Vec<(f64, f64)> {
    // Larger steps than one that is not finite are left out with it.
    let first = pairs.iter().rposition(|pair| !pair.is_finite()).map_or(0, |k| k + 1);
    let pairs = &pairs[first..];
    if pairs.len() < LEAST_STEPS {
        return vec![(f64::NAN, f64::INFINITY); centre.len()];
    }
    (0..centre.len()).map(|i| entry(i, centre[i], noise[i], pairs)).collect()
}

fn entry(i: usize, centre: f64, noise: f64, pairs: &[Pair<'_>]) -> (f64, f64) {
    let mut before: Vec<f64> = Vec::new();
    let mut estimates: Vec<(f64, f64)> = Vec::new();
    let mut bends: Vec<f64> = Vec::new();
    for pair in pairs {
        let (above, below) = (pair.above[i], pair.below[i]);
        let rounding = (noise + 2.0 * f64::EPSILON * above.abs().max(below.abs())) / pair.width;
        let mut row = vec![(above - below) / pair.width];
        let mut best = (row[0], f64::INFINITY);
        for (order, old) in before.iter().enumerate() {
            // Steps fall by 4, and the error has even powers of the step.
            let last = row[order];
            let next = last + (last - old) / (16.0_f64.powi(order as i32 + 1) - 1.0);
            let error = (next - last).abs().max((next - old).abs()) + rounding;
            if error < best.1 {
                best = (next, error);
            }
            row.push(next);
        }
        before = row;
        estimates.push(best);
        let bend = (above - 2.0 * centre + below).abs() / pair.width;
        // Roundings bend, too.
        if MIDDLE.contains(&pair.step) && bend > 4.0 * rounding {
            bends.push(bend);
        }
    }
    let trusted = pairs.iter().filter(|pair| pair.step < TRUSTED).count();
    let mut estimates = consistent(&estimates, trusted);
    estimates.sort_by(|a, b| a.1.total_cmp(&b.1));
    estimates.truncate(LEAST_STEPS);
    let (value, mut error) = estimates[0];
    // The least of many estimates is too small by chance. So the error is at least the distance to the next best values.
    let values = || estimates.iter().map(|(value, _)| *value);
    let spread = values().fold(f64::MIN, f64::max) - values().fold(f64::MAX, f64::min);
    error = error.max(spread);
    // Longer steps than the last ones may leave the neighbourhood in which both slopes are constant.
    let bends = &bends[bends.len().saturating_sub(LEAST_STEPS)..];
    if let (true, Some(last)) = (bends.len() == LEAST_STEPS, bends.last()) {
        // Half the difference of the slopes falls by 4 from step to step if the function is smooth, and grows by 4 by rounding.
        let most = bends.iter().copied().fold(0.0, f64::max);
        let least = bends.iter().copied().fold(f64::MAX, f64::min);
        if most < 2.0 * least {
            error += last;
        }
    }
    (value, error)
}

/// The estimates without those of long steps that two of shorter steps contradict, beyond the errors of both and the scatter of the
/// shorter ones: noise makes these differ, but not agree with each other. The first `trusted` ones are of steps that are long beside the
/// dead zone of a solver, which returns its warm start there; the others must agree with the best of them.
fn consistent(estimates: &[(f64, f64)], trusted: usize) -> Vec<(f64, f64)> {
    if trusted < LEAST_STEPS {
        return estimates.to_vec();
    }
    let scatter = |j: usize| {
        let other = if j + 1 < trusted { j + 1 } else { j - 1 };
        (estimates[j].0 - estimates[other].0).abs()
    };
    let contradicts = |k: usize, j: usize| {
        let ((a, a_error), (b, b_error)) = (estimates[k], estimates[j]);
        (a - b).abs() > APART * (a_error + b_error + scatter(j))
    };
    let is_contradicted = |k: &usize| (k + 1..trusted).filter(|j| contradicts(*k, *j)).count() >= 2;
    let first = (0..trusted).rev().find(is_contradicted).map_or(0, |k| k + 1);
    // Fewer are left by noise alone, whose errors are all too small.
    let first = first.min(trusted - LEAST_STEPS);
    let known = &estimates[first..trusted];
    let best = known.iter().copied().min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or(estimates[0]);
    let agrees = |other: &&(f64, f64)| (other.0 - best.0).abs() <= APART * (other.1 + best.1);
    known.iter().chain(estimates[trusted..].iter().filter(agrees)).copied().collect()
}
