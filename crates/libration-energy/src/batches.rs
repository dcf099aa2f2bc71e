//! Batch means of a trace.

use core::f64::consts::PI;
use core::ops::Range;

/// Expected distance of two independent times of a batch, in lengths of the batch: ∬ w(x) w(y) |x − y| dx dy of the weights w.
pub(crate) const MEAN_DISTANCE: f64 = 0.160_9;

/// Integral of the squared weights over a batch of length 1: (35/128)/(3/8)².
pub(crate) const SQUARED_WEIGHTS: f64 = 35.0 / 18.0;

/// Batches of equal numbers of samples, each averaged with the weights sin⁴ of a window. Means of an oscillation with period P over
/// batches of length L fall as (P/L)⁵, and neighbouring means of correlated noise are nearly independent. The method of batch means:
/// Flyvbjerg and Petersen, J. Chem. Phys. 91, 461 (1989).
#[derive(Clone, Debug)]
pub(crate) struct Batches {
    /// Samples of each batch.
    ranges: Vec<Range<usize>>,
    /// Mean times.
    pub times: Vec<f64>,
}

impl Batches {
    /// Divides the times of a trace into a number of batches.
    pub(crate) fn of(times: &[f64], count: usize) -> Self {
        let edge = |k: usize| k * times.len() / count;
        let ranges: Vec<Range<usize>> = (0..count).map(|k| edge(k)..edge(k + 1)).collect();
        let mut batches = Batches { ranges, times: Vec::new() };
        batches.times = batches.means(times);
        batches
    }

    /// Number of batches.
    pub(crate) fn count(&self) -> usize {
        self.ranges.len()
    }

    /// Time from batch to batch.
    pub(crate) fn spacing(&self) -> f64 {
        match (self.times.first(), self.times.last()) {
            (Some(first), Some(last)) => (last - first) / (self.count() - 1).max(1) as f64,
            _ => f64::NAN,
        }
    }

    /// The weighted mean of each batch.
    pub(crate) fn means(&self, values: &[f64]) -> Vec<f64> {
        self.ranges.iter().map(|range| mean(&values[range.clone()], |x| x)).collect()
    }

    /// The values less the means of their batches.
    pub(crate) fn centred(&self, values: &[f64]) -> Vec<f64> {
        let centred = |range: &Range<usize>| {
            let part = &values[range.clone()];
            let center = mean(part, |x| x);
            part.iter().map(move |x| x - center)
        };
        self.ranges.iter().flat_map(centred).collect()
    }

    /// The weighted variance within each batch.
    pub(crate) fn variances(&self, values: &[f64]) -> Vec<f64> {
        let variance = |range: &Range<usize>| {
            let part = &values[range.clone()];
            let center = mean(part, |x| x);
            mean(part, |x| (x - center) * (x - center))
        };
        self.ranges.iter().map(variance).collect()
    }
}

/// The mean of a function of the values, with the weights of the window.
fn mean(values: &[f64], function: impl Fn(f64) -> f64) -> f64 {
    let step = PI / values.len() as f64;
    let (mut sum, mut total) = (0.0, 0.0);
    for (k, value) in values.iter().enumerate() {
        let weight = (step * (k as f64 + 0.5)).sin().powi(4);
        sum += weight * function(*value);
        total += weight;
    }
    sum / total
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_distance_is_that_of_the_weights() {
        const POINTS: usize = 400;
        let weight = |k: usize| (PI * (k as f64 + 0.5) / POINTS as f64).sin().powi(4);
        let total: f64 = (0..POINTS).map(weight).sum();
        let mut distance = 0.0;
        for i in 0..POINTS {
            for j in 0..POINTS {
                distance += weight(i) * weight(j) * i.abs_diff(j) as f64;
            }
        }
        let found = distance / (total * total * POINTS as f64);
        // The constant has four digits; the sum errs by the square of a cell.
        assert!((found - MEAN_DISTANCE).abs() < 1e-4, "{found}");
    }

    #[test]
    fn means_of_an_oscillation_fall_with_the_fifth_power_of_the_batch() {
        // 8 and 16 and a half periods in a batch: the tail of the transform of sin⁴ is (P/L)⁵, 32 times less.
        let amplitude = |periods: f64| {
            let samples = 48 * 1000;
            let phase = |i: usize| 2.0 * PI * periods * i as f64 / 1000.0;
            let times: Vec<f64> = (0..samples).map(|i| i as f64).collect();
            let values: Vec<f64> = (0..samples).map(|i| phase(i).sin()).collect();
            let means = Batches::of(&times, 48).means(&values);
            means.iter().fold(0.0_f64, |most, mean| most.max(mean.abs()))
        };
        let ratio = amplitude(8.5) / amplitude(17.0 + 1.0 / 2.0);
        // (17.5/8.5)⁵ = 36.99; the next term of the tail is of relative order 20 (2/8.5)²/4π²… below 20 %.
        assert!((ratio / 36.99 - 1.0).abs() < 0.2, "{ratio}");
    }
}
