//! The likelihood over dead time and lag.

use serde::Serialize;

use crate::estimate::Estimate;
use crate::recording::Recording;

/// The log likelihood over the first two parameters of a response, below its maximum.
#[derive(Clone, Debug, Serialize)]
pub struct LikelihoodMap {
    /// Dead times in s.
    pub dead_times: Vec<f64>,
    /// Values of the second parameter.
    pub seconds: Vec<f64>,
    /// `2 (ln L_max − ln L)`, a row for each value of the second parameter.
    pub deficits: Vec<Vec<f64>>,
    /// Whether other parameters, such as a damping ratio or the colour of the noise, stay at their estimates. Gain, load, initial state and
    /// the variance of the noise never do.
    pub is_slice: bool,
}

/// Points in each direction.
const POINTS: usize = 41;

/// The map over these ranges. Gain, load, initial state and the variance of the noise are those of greatest likelihood at each point.
pub(crate) fn likelihood_map(
    estimate: &Estimate<'_>,
    recording: &Recording,
    ranges: [(f64, f64); 2],
) -> LikelihoodMap {
    let points = |(low, high): (f64, f64)| -> Vec<f64> {
        (0..POINTS).map(|i| low + (high - low) * i as f64 / (POINTS - 1) as f64).collect()
    };
    let [dead_times, seconds] = ranges.map(points);
    let estimate = &estimate.with_effort(estimate.model.effort.unbounded());
    let window = estimate.model.window(recording);
    let deficits = seconds
        .iter()
        .map(|&second| {
            let at = |&dead_time: &f64| {
                let mut coordinates = estimate.coordinates.clone();
                (coordinates[0], coordinates[1]) = (dead_time, second);
                2.0 * (estimate.model.cost(window, &coordinates) + estimate.log_likelihood)
            };
            dead_times.iter().map(at).collect()
        })
        .collect();
    LikelihoodMap { dead_times, seconds, deficits, is_slice: estimate.coordinates.len() > 2 }
}
