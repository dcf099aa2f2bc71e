//! Whether residuals contradict a model.

use libration::linear::{Matrix, solve_matrix};
use serde::Serialize;

use crate::estimate::Estimate;
use crate::quantiles::{chi_squared_tail, normal_tails};
use crate::recording::Recording;

/// Tests of the residuals of a fit.
#[derive(Clone, Debug, Serialize)]
pub struct ResidualTests {
    /// The probability of residuals at least as correlated, if they are independent (Ljung and Box).
    pub whiteness: f64,
    /// The correlation of neighbouring residuals.
    pub correlation: f64,
    /// The probability of residuals at least as correlated with earlier changes of the command, if the response is that of the model.
    pub command: f64,
    /// The probability of commands at least as correlated with earlier residuals, if nothing feeds the response back.
    pub feedback: f64,
    /// Excess kurtosis; zero for normal residuals.
    pub excess_kurtosis: f64,
    /// The probability of a kurtosis at least as far from normal.
    pub normality: f64,
}

/// Lags of the tests.
const LAGS: usize = 20;
/// A probability below this contradicts a model.
pub const CONTRADICTION: f64 = 1e-3;

impl ResidualTests {
    /// Whether the residuals contradict the model.
    pub fn contradict(&self) -> bool {
        self.whiteness < CONTRADICTION || self.command < CONTRADICTION
    }

    /// Whether another law of arrivals may explain more.
    pub(crate) fn are_suspect(&self) -> bool {
        self.contradict() || (self.normality < CONTRADICTION && self.excess_kurtosis > 0.0)
    }

    /// The tests of a fit.
    pub(crate) fn of(estimate: &Estimate<'_>, recording: &Recording) -> Self {
        let used = estimate.model.coordinates() - estimate.model.free_shape();
        let first = estimate.model.window(recording).first;
        Self::new(&estimate.regression.residuals, used, first, recording)
    }

    /// The tests of residuals of a model whose noise has `used` parameters, for the responses from the `first` on.
    pub(crate) fn new(residuals: &[f64], used: usize, first: usize, recording: &Recording) -> Self {
        let n = residuals.len();
        let lags = LAGS.min(n / 5);
        let mean = residuals.iter().sum::<f64>() / n as f64;
        let centred: Vec<f64> = residuals.iter().map(|residual| residual - mean).collect();
        let square: f64 = centred.iter().map(|x| x * x).sum();
        let correlation = |lag: usize| -> f64 {
            (lag..n).map(|i| centred[i] * centred[i - lag]).sum::<f64>() / square
        };
        let count = n as f64;
        // G. M. Ljung and G. E. P. Box, Biometrika 65, 1978.
        let statistic: f64 =
            (1..=lags).map(|lag| correlation(lag).powi(2) / (n - lag) as f64).sum::<f64>()
                * count
                * (count + 2.0);
        let whiteness = chi_squared_tail(statistic, lags.saturating_sub(used) as f64);
        let changes = changes(first, recording);
        let command = cross(&centred, &changes, 1..lags + 1, false);
        let feedback = cross(&centred, &changes, 0..lags, true);
        let variance = square / count;
        let fourth = centred.iter().map(|x| x.powi(4)).sum::<f64>() / count;
        let excess_kurtosis = fourth / (variance * variance) - 3.0;
        ResidualTests {
            whiteness,
            correlation: correlation(1),
            command,
            feedback,
            excess_kurtosis,
            normality: normal_tails(excess_kurtosis / (24.0 / count).sqrt()),
        }
    }
}

/// The change of the command between one response and the next.
fn changes(first: usize, recording: &Recording) -> Vec<f64> {
    let times = &recording.response_times;
    let command = |time: f64| {
        let k = recording.command_times.partition_point(|&t| t <= time);
        recording.commands[k.saturating_sub(1)]
    };
    let all: Vec<f64> = (first..times.len())
        .map(|i| if i == 0 { 0.0 } else { command(times[i]) - command(times[i - 1]) })
        .collect();
    // Rare large steps, as of a reference, would hide what feedback does all the time.
    let mut sizes: Vec<f64> = all.iter().map(|change| change.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let most = match sizes.get(sizes.len() / 2) {
        Some(&median) if median > 0.0 => 3.0 * median,
        _ => f64::INFINITY,
    };
    let clipped: Vec<f64> = all.iter().map(|change| change.clamp(-most, most)).collect();
    let mean = clipped.iter().sum::<f64>() / clipped.len() as f64;
    clipped.iter().map(|change| change - mean).collect()
}

/// The probability of correlations of white `residuals` with a signal at least as large, if both are independent: at `lags` from `first`
/// on, by which the signal is later or earlier than the residuals.
///
/// The estimates of neighbouring lags are as correlated as the signal.
fn cross(residuals: &[f64], signal: &[f64], lags: core::ops::Range<usize>, is_later: bool) -> f64 {
    let n = residuals.len();
    let power: f64 = residuals.iter().map(|x| x * x).sum::<f64>() / n as f64;
    let product =
        |x: &[f64], y: &[f64], lag: usize| -> f64 { (lag..n).map(|i| x[i] * y[i - lag]).sum() };
    let count = lags.len();
    let own: Vec<f64> = (0..count).map(|lag| product(signal, signal, lag)).collect();
    if [own[0], power].iter().any(|x| x.is_nan() || *x <= 0.0) {
        return 1.0;
    }
    let found: Vec<f64> = lags
        .map(|lag| match is_later {
            true => product(signal, residuals, lag),
            false => product(residuals, signal, lag),
        })
        .collect();
    // A little of white noise, so that a periodic signal has an inverse.
    let covariance = Matrix::from_fn(count, count, |i, j| {
        let ridge = if i == j { 1e-6 } else { 0.0 };
        power * (own[i.abs_diff(j)] + ridge * own[0])
    });
    let right = Matrix::from_fn(count, 1, |i, _| found[i]);
    let statistic = solve_matrix(&covariance, &right)
        .map_or(0.0, |solved| found.iter().enumerate().map(|(i, x)| x * solved[(i, 0)]).sum());
    chi_squared_tail(statistic, count as f64)
}
