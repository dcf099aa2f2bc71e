//! The fluctuation of an energy about its trend.

use crate::batches::{Batches, MEAN_DISTANCE, SQUARED_WEIGHTS};
use crate::estimate::{Estimate, NORMAL_95, student};
use crate::walk::Walk;

/// Autocorrelation times in a run below which its fluctuation has no interval. A batch of 12 that is as short as a few memories shows about
/// half of the autocorrelation time: 100 are about 55 memories.
const LEAST_TIMES: f64 = 120.0;
/// Variance about the line, by that within batches, above which a possible walk may be a memory that the batches do not hold.
const SLOW: f64 = 1.05;

/// The fluctuation about a trend.
pub(crate) struct Fluctuation {
    /// Standard deviation; without an interval if the run is too short for one.
    pub oscillation: Estimate,
    /// Integrated autocorrelation time in s; none under a walk.
    pub correlation_time: Option<f64>,
}

impl Fluctuation {
    pub(crate) fn of(
        batches: &Batches,
        residuals: &[f64],
        walk: Option<&Walk>,
        duration: f64,
        drifts: bool,
    ) -> Self {
        let means = batches.means(residuals);
        let count = means.len() as f64;
        let spacing = batches.spacing();
        // Of a walk only the part within a batch: half of the mean distance of its times, by the variance per second.
        let (white, wander) = match walk {
            Some(walk) => (0.0, 0.5 * MEAN_DISTANCE * spacing * walk.diffusion.value),
            None => (means.iter().map(|mean| mean * mean).sum::<f64>() / (count - 2.0), 0.0),
        };
        let variances = batches.variances(residuals);
        let mean = variances.iter().sum::<f64>() / count;
        let scatter = variances.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>();
        // The variance of the means has the error of a variance with as many degrees of freedom.
        let error =
            (scatter / (count - 1.0) / count).sqrt().hypot(white * (2.0 / (count - 2.0)).sqrt());
        let half_width = student(NORMAL_95, means.len() - 1) * error;
        let size = |variance: f64| (variance - wander + white).max(0.0).sqrt();
        let value = size(mean);
        // A mean over a batch of length L has the variance 2 τ σ² Σw²/L.
        let per_time = spacing / (2.0 * SQUARED_WEIGHTS * value.powi(2));
        let correlation_time = (walk.is_none() && per_time.is_finite()).then_some(white * per_time);
        // The line takes two degrees of freedom.
        let about_line =
            residuals.iter().map(|x| x * x).sum::<f64>() / (residuals.len() - 2) as f64;
        let is_slow = walk.is_some() && about_line > SLOW * value * value;
        let is_short = correlation_time.is_some_and(|time| duration < LEAST_TIMES * time);
        // The curvature of a drift is no memory.
        let oscillation = match !drifts && (is_slow || is_short) {
            // What a walk that is present leaves is the oscillation; one that is only possible may be a part of it.
            true if walk.is_some_and(|walk| walk.is_present) => Estimate::unbounded(value),
            true => Estimate::unbounded(about_line.sqrt()),
            // Errors of variances are nearly in proportion to them.
            false => {
                let factor = (0.5 * half_width / (value * value)).exp();
                match factor.is_finite() {
                    true => Estimate { value, low: value / factor, high: value * factor },
                    false => Estimate { value, low: 0.0, high: size(mean + half_width) },
                }
            }
        };
        Fluctuation { oscillation, correlation_time }
    }
}
