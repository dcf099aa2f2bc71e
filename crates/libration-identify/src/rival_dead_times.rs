//! Dead times that fit as well as the estimate, and are far from it: those of a command that repeats itself.

use crate::estimate::Estimate;
use crate::interval::{EFFORTS, Interval};
use crate::recording::Recording;

/// A log likelihood that falls by this much is excluded at a probability of 10⁻³: `½χ²` with one degree of freedom.
const EXCLUDED: f64 = 5.41;
/// Most dead times of the first search.
const DEAD_TIMES: f64 = 400.0;
/// Most minima of the first search that are followed.
const FOLLOWED: usize = 6;

/// The dead times, in s, by their distance from the estimate; `None` if the effort ends before.
pub(crate) fn rival_dead_times(
    estimate: &Estimate<'_>,
    interval: Option<Interval>,
    recording: &Recording,
) -> Option<Vec<f64>> {
    let effort = estimate.model.effort.renewed(EFFORTS);
    let model = &estimate.model.with_effort(effort);
    if model.known[0].is_some() {
        return Some(Vec::new());
    }
    let own = estimate.point.shape[0];
    let width = interval.map_or(0.0, |found| found.high.unwrap_or(model.longest) - found.low);
    let is_far = |dead_time: f64| (dead_time - own).abs() > 1.5 * width + model.interval;
    let grid = (0.5 * model.interval).max(model.longest / DEAD_TIMES);
    let count = (model.longest / grid).floor() as usize;
    let window = model.window(recording);
    let at = |i: usize| {
        let mut coordinates = estimate.coordinates.clone();
        coordinates[0] = grid * i as f64;
        coordinates
    };
    let costs: Vec<f64> = (0..=count).map(|i| model.cost(window, &at(i))).collect();
    let cost = |i: usize| costs.get(i).copied().unwrap_or(f64::INFINITY);
    let is_minimum = |&i: &usize| cost(i) <= cost(i + 1) && (i == 0 || cost(i) < cost(i - 1));
    let mut minima: Vec<usize> =
        (0..=count).filter(is_minimum).filter(|&i| is_far(grid * i as f64)).collect();
    minima.sort_by(|&a, &b| cost(a).total_cmp(&cost(b)));
    let mut found: Vec<f64> = Vec::new();
    for i in minima.into_iter().take(FOLLOWED) {
        let fit = Estimate::from_start(model, recording, &at(i), 0.2 * grid);
        let Some(fit) = fit.filter(|fit| {
            fit.log_likelihood > estimate.log_likelihood - EXCLUDED && is_far(fit.point.shape[0])
        }) else {
            continue;
        };
        let dead_time = fit.point.shape[0];
        if !found.iter().any(|other| (other - dead_time).abs() < model.interval) {
            found.push(dead_time);
        }
    }
    found.sort_by(|a, b| (a - own).abs().total_cmp(&(b - own).abs()));
    (!model.effort.is_exhausted()).then_some(found)
}
