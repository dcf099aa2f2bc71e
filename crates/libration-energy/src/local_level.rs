//! A trend under white noise and a random walk.

use crate::estimate::Estimate;
use crate::normal_equations::{Row, Solution, least_squares};

/// Twice the difference of log-likelihoods from which on a random walk widens the interval of the rate: the level is 5 %.
pub(crate) const POSSIBLE: f64 = 2.7;
/// Decades and points per decade of the ratios of variances that are tried.
const DECADES: (i32, i32) = (-5, 5);
const POINTS: i32 = 8;
/// Half of the 95 % quantile of χ² with one degree of freedom.
const LIKELY: f64 = 1.921;

/// The fit of y = trend + random walk + white noise at equal distances, by restricted maximum likelihood.
///
/// Harvey, *Forecasting, Structural Time Series Models and the Kalman Filter* (1989), sections 3.4 and 4.3: a local level with
/// regressors. Its filter takes the correlation out of values and regressors, so that the rate is one of generalised least squares.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LocalLevel {
    /// Change of the trend over all values, with its standard error.
    pub change: f64,
    pub standard_error: f64,
    /// Value of the trend in the middle.
    pub middle: f64,
    /// Degrees of freedom of the standard error.
    pub degrees_of_freedom: usize,
    /// Variance of the white noise.
    pub white: f64,
    /// Variance of a step of the random walk.
    pub walk: Estimate,
    /// Twice the logarithm of the ratio of likelihoods, with and without the walk.
    pub evidence: f64,
}

impl LocalLevel {
    /// Fits a polynomial trend with `terms` terms, 2 (a line) or 3 (a parabola), at these times.
    pub(crate) fn fit(times: &[f64], values: &[f64], terms: usize) -> Option<Self> {
        let (first, last) = (times.first()?, times.last()?);
        let (middle, half) = ((first + last) / 2.0, (last - first) / 2.0);
        // Legendre's polynomials: nearly orthogonal columns.
        let columns = |t: &f64| {
            let x = (t - middle) / half;
            [1.0, x, 1.5 * x * x - 0.5]
        };
        let rows: Vec<Row> =
            times.iter().zip(values).map(|(t, value)| (columns(t), *value)).collect();
        let degrees_of_freedom = rows.len().checked_sub(terms).filter(|count| *count > 0)?;
        let fit = |ratio: f64| Fit::of(&rows, ratio, terms);
        let alone = fit(0.0)?;
        let exponents = POINTS * DECADES.0..=POINTS * DECADES.1;
        let tried: Vec<Fit> = exponents
            .filter_map(|k| fit(10.0_f64.powf(f64::from(k) / f64::from(POINTS))))
            .collect();
        let best = tried.iter().fold(&alone, |best, fit| match fit.likelihood > best.likelihood {
            true => fit,
            false => best,
        });
        let walk = interval(&alone, &tried, best, degrees_of_freedom as f64);
        let evidence = 2.0 * (best.likelihood - alone.likelihood);
        let used = if evidence > POSSIBLE { best } else { &alone };
        let solution = used.solution;
        Some(LocalLevel {
            change: 2.0 * solution.coefficients[1],
            standard_error: 2.0 * (solution.inverse_diagonal[1] * used.variance).sqrt(),
            middle: solution.coefficients[0],
            degrees_of_freedom,
            white: best.variance,
            walk,
            evidence,
        })
    }
}

/// The variance of a step of the walk, with its interval by the profile likelihood. A factor c of all variances costs
/// n/2·(ln c + 1/c − 1) ≈ n/4·ln² c.
fn interval(alone: &Fit, tried: &[Fit], best: &Fit, freedom: f64) -> Estimate {
    let (mut low, mut high) = (f64::INFINITY, 0.0_f64);
    for fit in [alone].into_iter().chain(tried) {
        let left = LIKELY - (best.likelihood - fit.likelihood);
        if left >= 0.0 {
            let factor = (2.0 * (left / freedom).sqrt()).exp();
            low = low.min(fit.ratio * fit.variance / factor);
            high = high.max(fit.ratio * fit.variance * factor);
        }
    }
    Estimate { value: best.ratio * best.variance, low, high }
}

/// A fit with a given ratio of variances.
struct Fit {
    ratio: f64,
    solution: Solution,
    /// Variance of the white noise.
    variance: f64,
    likelihood: f64,
}

impl Fit {
    fn of(rows: &[Row], ratio: f64, terms: usize) -> Option<Self> {
        let (whitened, log_variances) = innovations(rows, ratio);
        let solution = least_squares(&whitened, terms)?;
        let freedom = (rows.len() - terms) as f64;
        let variance = (solution.residual / freedom).max(f64::MIN_POSITIVE);
        let likelihood =
            -0.5 * (log_variances + solution.log_determinant + freedom * variance.ln());
        Some(Fit { ratio, solution, variance, likelihood })
    }
}

/// The innovations of all columns by Kalman's filter for a level that starts at zero, divided by their standard deviations, and the sum
/// of the logarithms of their variances.
fn innovations(rows: &[Row], ratio: f64) -> (Vec<Row>, f64) {
    let mut level: Row = ([0.0; 3], 0.0);
    let (mut variance, mut logs) = (0.0, 0.0);
    let mut whitened = Vec::with_capacity(rows.len());
    for (i, (x, y)) in rows.iter().enumerate() {
        // The trend has the level of the first value.
        let predicted = if i == 0 { 0.0 } else { variance + ratio };
        let total = predicted + 1.0;
        let gain = predicted / total;
        let scale = total.sqrt().recip();
        let mut innovation = (*x, y - level.1);
        for (entry, level) in innovation.0.iter_mut().zip(&mut level.0) {
            *entry -= *level;
            *level += gain * *entry;
        }
        level.1 += gain * innovation.1;
        whitened.push((innovation.0.map(|x| x * scale), innovation.1 * scale));
        logs += total.ln();
        variance = gain;
    }
    (whitened, logs)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_filter_gives_the_fit_and_the_likelihood_of_the_whole_covariance_matrix() {
        const N: usize = 6;
        let values = [0.3, -1.2, 2.5, 0.9, 3.1, 2.2];
        let rows: Vec<Row> =
            values.iter().enumerate().map(|(i, y)| ([1.0, i as f64 - 2.5, 0.0], *y)).collect();
        let ratio = 0.7;
        // Covariances of white noise and of a walk that starts at the first value: δ_ij + ratio·min(i, j).
        let covariance = |i: usize, j: usize| f64::from(i == j) + ratio * i.min(j) as f64;
        // Cholesky's factor, and its inverse on each column.
        let mut factor = [[0.0; N]; N];
        for i in 0..N {
            for j in 0..=i {
                let known: f64 = (0..j).map(|k| factor[i][k] * factor[j][k]).sum();
                let rest = covariance(i, j) - known;
                factor[i][j] = if i == j { rest.sqrt() } else { rest / factor[j][j] };
            }
        }
        let mut whitened: Vec<Row> = Vec::new();
        for i in 0..N {
            let solve = |own: f64, entry: &dyn Fn(&Row) -> f64| {
                let known: f64 = (0..i).map(|k| factor[i][k] * entry(&whitened[k])).sum();
                (own - known) / factor[i][i]
            };
            let x = [0, 1].map(|c| solve(rows[i].0[c], &|row| row.0[c]));
            let y = solve(rows[i].1, &|row| row.1);
            whitened.push(([x[0], x[1], 0.0], y));
        }
        let whole = least_squares(&whitened, 2).unwrap();
        let logs: f64 = (0..N).map(|i| 2.0 * factor[i][i].ln()).sum();
        let freedom = (N - 2) as f64;
        let variance = whole.residual / freedom;
        let likelihood = -0.5 * (logs + whole.log_determinant + freedom * variance.ln());
        let fit = Fit::of(&rows, ratio, 2).unwrap();
        // Both are sums of about ten roundings.
        let pairs = [
            (fit.solution.coefficients[1], whole.coefficients[1]),
            (fit.solution.inverse_diagonal[1], whole.inverse_diagonal[1]),
            (fit.variance, variance),
            (fit.likelihood, likelihood),
        ];
        for (filtered, dense) in pairs {
            assert!((filtered / dense - 1.0).abs() < 1e-13, "{filtered} {dense}");
        }
    }
}
