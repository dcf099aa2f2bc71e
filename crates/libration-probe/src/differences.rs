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
/// kink it includes half the difference of the slopes on both sides. Steps to where the function is not finite are left out.
///
/// `coarseness` is the rounding of values relative to them that close points do not show, such as that of single precision; else 0.
///
/// # Errors
/// Those of the function.
pub fn jacobian<E>(
    mut function: impl FnMut(&Matrix) -> Result<Matrix, E>,
    z: &[f64],
    scale: &[f64],
    coarseness: f64,
) -> Result<Jacobian, E> {
    let points = Points::new(z, scale);
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
        let pairs: Vec<Pair<'_>> = (0..STEPS)
            .map(|k| {
                let at = points.index(j, k);
                let width = points.states[(at, j)] - points.states[(at + 1, j)];
                Pair { step: k, above: values.row(at), below: values.row(at + 1), width }
            })
            .collect();
        for (i, (value, error)) in column(centre, &noise, &pairs).into_iter().enumerate() {
            found.values[(i, j)] = value;
            found.errors[(i, j)] = error;
        }
    }
    Ok(found)
}

/// All points of a Jacobian: the centre, close points, and pairs on both sides in each variable.
struct Points {
    states: Matrix,
}

impl Points {
    fn new(z: &[f64], scale: &[f64]) -> Self {
        let n = z.len();
        let mut rows: Vec<Vec<f64>> = vec![z.to_vec()];
        for k in 0..CLOSE {
            let shift = (k as f64 - CLOSE as f64 / 2.0) * 2.0_f64.powi(-40);
            rows.push(z.iter().zip(scale).map(|(z, scale)| z + shift * scale).collect());
        }
        for j in 0..n {
            for k in 0..STEPS {
                let step = scale[j] * 2.0_f64.powi(-4 - 2 * k as i32);
                for side in [step, -step] {
                    let mut point = z.to_vec();
                    point[j] += side;
                    rows.push(point);
                }
            }
        }
        Points { states: Matrix::from_fn(rows.len(), n, |i, j| rows[i][j]) }
    }

    /// The row of the upper point of step `k` in variable `j`; the lower one follows.
    fn index(&self, j: usize, k: usize) -> usize {
        1 + CLOSE + 2 * (j * STEPS + k)
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
    estimates.sort_by(|a, b| a.1.total_cmp(&b.1));
    estimates.truncate(LEAST_STEPS);
    let (value, mut error) = estimates[0];
    // The least of many estimates is too small by chance. So the error is at least the distance to the next best values.
    let values = || estimates.iter().map(|(value, _)| *value);
    let spread = values().fold(f64::MIN, f64::max) - values().fold(f64::MAX, f64::min);
    error = error.max(spread);
    if let (true, Some(last)) = (bends.len() > 2, bends.last()) {
        // Half the difference of the slopes falls by 4 from step to step if the function is smooth, and grows by 4 by rounding.
        let most = bends.iter().copied().fold(0.0, f64::max);
        let least = bends.iter().copied().fold(f64::MAX, f64::min);
        if most < 2.0 * least {
            error += last;
        }
    }
    (value, error)
}
