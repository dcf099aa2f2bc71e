//! Fisher's information of a fit.

use libration::linear::{Matrix, solve_matrix};

use crate::estimate::Estimate;
use crate::recording::Recording;
use crate::whitening::Whitened;

/// The covariance of the estimates, by Fisher's information.
#[derive(Clone, Debug)]
pub(crate) struct Information {
    /// Coordinates, then coefficients that were solved for; NaN for those on which the likelihood does not depend.
    pub(crate) covariance: Matrix,
    /// The coefficients that were solved for.
    pub(crate) coefficients: Vec<usize>,
}

/// Central differences are taken over this part of an interval.
const DIFFERENCE: f64 = 1e-3;

/// Coordinates of noise are logarithms: with less information than this its part in the recording is nothing.
const LEAST_OF_NOISE: f64 = 1e-6;

/// The covariance of the estimates; `None` if the information has no inverse: something cannot be told at all.
///
/// With independent errors `ν` of variance `v`: `Σ ∂ν∂νᵀ/v + ½ Σ ∂ln v ∂ln vᵀ` (Fisher's information of Gaussian variables; B. Porat,
/// *Digital Processing of Random Signals*, 1994, section 3.3). Derivatives are central differences: a response that follows steps has a
/// kink in its dead time wherever an arrival meets a sample, and there they are the mean of both sides.
pub(crate) fn information(estimate: &Estimate<'_>, recording: &Recording) -> Option<Information> {
    let model = &estimate.model;
    let window = model.window(recording);
    let coefficients = &estimate.regression.coefficients;
    let variance = estimate.variance();
    let whitened = model.whitened(window, &estimate.point);
    let count = whitened.responses.len();
    let columns = whitened.columns;
    // Derivatives of the residual and of the logarithm of its variance, for each parameter.
    let mut rows: Vec<(Vec<f64>, Vec<f64>)> = Vec::new();
    for i in 0..model.coordinates() {
        let is_time = i < model.free_shape();
        let step = match is_time {
            true => DIFFERENCE * estimate.coordinates[i].abs().max(model.interval),
            false => {
                DIFFERENCE
                    * estimate.coordinates[i]
                        .abs()
                        .max(0.1 * model.noise_start().1[i - model.free_shape()])
            }
        };
        let at = |sign: f64| {
            let mut moved = estimate.coordinates.clone();
            moved[i] += sign * step;
            model.point(&moved).map(|point| model.whitened(window, &point))
        };
        // At a bound of the model there is one side; below zero is its mirror image.
        let is_at_zero = is_time && estimate.coordinates[i].abs() < step;
        let (below, above) = (if is_at_zero { None } else { at(-1.0) }, at(1.0));
        let width =
            step * (f64::from(u8::from(below.is_some())) + f64::from(u8::from(above.is_some())));
        let [below, above] = [below, above].map(|side| side.unwrap_or_else(|| whitened.clone()));
        let residual = |whitened: &Whitened, k: usize| {
            let row = &whitened.regressors[k * columns..(k + 1) * columns];
            whitened.responses[k] - row.iter().zip(coefficients).map(|(x, c)| x * c).sum::<f64>()
        };
        if below.columns != columns || above.columns != columns {
            // A lag that vanishes takes its state with it.
            rows.push((vec![0.0; count], vec![0.0; count]));
            continue;
        }
        rows.push(
            (0..count)
                .map(|k| {
                    let root = whitened.scales[k].sqrt();
                    (
                        (residual(&above, k) - residual(&below, k)) / (width * root),
                        (above.scales[k] / below.scales[k]).ln() / width,
                    )
                })
                .unzip(),
        );
    }
    let solved: Vec<usize> = (0..columns)
        .filter(|&column| coefficients[column] != 0.0 && (column > 0 || model.gain.is_none()))
        .collect();
    for &column in &solved {
        let regressor = (0..count)
            .map(|k| -whitened.regressors[k * columns + column] / whitened.scales[k].sqrt())
            .collect();
        rows.push((regressor, vec![0.0; count]));
    }
    // Last: the logarithm of σ².
    rows.push((vec![0.0; count], vec![1.0; count]));
    let inner = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
    let n = rows.len();
    let full = Matrix::from_fn(n, n, |i, j| {
        inner(&rows[i].0, &rows[j].0) / variance + 0.5 * inner(&rows[i].1, &rows[j].1)
    });
    // Of what the likelihood does not depend on, as of a dead time between two samples, there is no error; the others have theirs.
    let noises = model.free_shape()..model.coordinates();
    let least = |i: usize| if noises.contains(&i) { LEAST_OF_NOISE } else { 0.0 };
    let kept: Vec<usize> = (0..n).filter(|&i| full[(i, i)] > least(i)).collect();
    let part = Matrix::from_fn(kept.len(), kept.len(), |i, j| full[(kept[i], kept[j])]);
    let inverse = inverse(&part)?;
    let mut covariance = Matrix::from_fn(n - 1, n - 1, |_, _| f64::NAN);
    for (i, &row) in kept.iter().enumerate() {
        for (j, &column) in kept.iter().enumerate() {
            if row < n - 1 && column < n - 1 {
                covariance[(row, column)] = inverse[(i, j)];
            }
        }
    }
    Some(Information { covariance, coefficients: solved })
}

/// The inverse of a symmetric matrix, scaled to a unit diagonal; `None` if rounding leaves nothing of it.
fn inverse(matrix: &Matrix) -> Option<Matrix> {
    let n = matrix.rows();
    let roots: Vec<f64> = (0..n).map(|i| matrix[(i, i)].sqrt()).collect();
    if roots.iter().any(|root| !(*root > 0.0 && root.is_finite())) {
        return None;
    }
    let scaled = Matrix::from_fn(n, n, |i, j| matrix[(i, j)] / (roots[i] * roots[j]));
    let inverse = solve_matrix(&scaled, &Matrix::identity(n))?;
    let is_good = (0..n).all(|i| inverse[(i, i)] > 0.0 && inverse[(i, i)] < 1e10);
    is_good.then(|| Matrix::from_fn(n, n, |i, j| inverse[(i, j)] / (roots[i] * roots[j])))
}
