//! Intervals by the profile of the likelihood.

use serde::Serialize;

use crate::estimate::{Estimate, TOLERANCE};
use crate::minimum::simplex;
use crate::model::Model;
use crate::quantiles::student;
use crate::recording::Recording;
use crate::whitening::COMMAND;

/// A 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Interval {
    /// The lower end; a bound of the parameter if the recording does not exclude it.
    pub low: f64,
    /// The upper end; `null` if the recording excludes no large value.
    pub high: Option<f64>,
}

impl Interval {
    /// Whether the interval has `value`.
    pub fn contains(&self, value: f64) -> bool {
        value >= self.low && self.high.is_none_or(|high| value <= high)
    }
}

/// The effort of a profile, over that of the search of a model.
pub(crate) const EFFORTS: u64 = 3;

/// What an interval is of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Functional {
    /// A free parameter, by its place among the coordinates.
    Coordinate(usize),
    /// The sum of the first two: of dead time and lag.
    Sum,
    /// The gain.
    Gain,
}

/// The interval of values that a likelihood ratio does not exclude (W. Q. Meeker and L. A. Escobar, American Statistician 49, 1995), with
/// Student's quantile in place of the normal one for short recordings.
///
/// It needs no smooth likelihood: with commands in steps, the likelihood has a kink in the dead time wherever an arrival meets a sample, and
/// simulators put it right there. `None` if the effort ends before the profile.
pub(crate) fn profile_interval(
    estimate: &Estimate<'_>,
    recording: &Recording,
    of: Functional,
    deviation: Option<f64>,
) -> Option<Interval> {
    let effort = estimate.model.effort.renewed(EFFORTS);
    let estimate = &estimate.with_effort(effort);
    let count = estimate.regression.residuals.len() as f64;
    let freedom = (count - estimate.parameters() as f64).max(1.0);
    let threshold = 0.5 * count * (student(freedom).powi(2) / freedom).ln_1p();
    let value = match of {
        Functional::Coordinate(i) => estimate.coordinates[i].abs(),
        Functional::Sum => estimate.coordinates[0].abs() + estimate.coordinates[1].abs(),
        Functional::Gain => estimate.regression.coefficients[COMMAND],
    };
    let first = deviation.filter(|step| step.is_finite() && *step > 0.0);
    let first = first.unwrap_or(0.1 * estimate.model.interval);
    let low = end(estimate, recording, of, value, -first, threshold);
    let high = end(estimate, recording, of, value, first, threshold);
    let lowest = if of == Functional::Gain { f64::NEG_INFINITY } else { 0.0 };
    let found = Interval { low: low.unwrap_or(lowest), high };
    (!estimate.model.effort.is_exhausted()).then_some(found)
}

/// The end of an interval on the side of `step`; `None` if it has none.
fn end(
    estimate: &Estimate<'_>,
    recording: &Recording,
    of: Functional,
    centre: f64,
    step: f64,
    threshold: f64,
) -> Option<f64> {
    let mut warm = others(&estimate.coordinates, of);
    let mut excess = |at: f64| -> f64 {
        let (cost, found) = constrained(estimate, recording, of, at, &warm);
        if cost.is_finite() {
            warm = found;
        }
        cost + estimate.log_likelihood - threshold
    };
    let limit = match of {
        Functional::Gain => centre + 1e3 * step,
        _ if step < 0.0 => 0.0,
        _ => 1e3 * (centre + estimate.model.interval),
    };
    // Outward until the likelihood has fallen far enough.
    let (mut inner, mut inner_excess) = (centre, -threshold);
    let mut width = step;
    let (mut outer, mut outer_excess) = loop {
        let at = centre + width;
        let is_last = if step < 0.0 { at <= limit } else { at >= limit };
        let at = if is_last { limit } else { at };
        let found = excess(at);
        // Outside of the model there is no end.
        if found == f64::INFINITY && step > 0.0 {
            return None;
        }
        if found >= 0.0 {
            break (at, found);
        }
        if is_last {
            return None;
        }
        (inner, inner_excess) = (at, found);
        width *= 1.8;
    };
    // The root of the excess is nearly linear in the distance: regula falsi on it, with halving where that stalls.
    let root = |excess: f64| (excess + threshold).max(0.0).sqrt();
    let target = threshold.sqrt();
    for round in 0..24 {
        if (outer - inner).abs() <= 1e-3 * (outer - centre).abs() {
            break;
        }
        let is_usable = outer_excess.is_finite() && round % 3 != 2;
        let part = match is_usable {
            true => {
                let (a, b) = (root(inner_excess), root(outer_excess));
                ((target - a) / (b - a)).clamp(0.02, 0.98)
            }
            false => 0.5,
        };
        let at = inner + part * (outer - inner);
        let found = excess(at);
        if found >= 0.0 {
            (outer, outer_excess) = (at, found);
        } else {
            (inner, inner_excess) = (at, found);
        }
    }
    Some(0.5 * (inner + outer))
}

/// The coordinates without that of the functional.
fn others(coordinates: &[f64], of: Functional) -> Vec<f64> {
    let left_out = match of {
        Functional::Coordinate(i) => Some(i),
        Functional::Sum => Some(0),
        Functional::Gain => None,
    };
    let kept = coordinates.iter().enumerate().filter(|&(i, _)| Some(i) != left_out);
    kept.map(|(_, &x)| x).collect()
}

/// The least cost with the functional at `at`, and the other coordinates there.
pub(crate) fn constrained(
    estimate: &Estimate<'_>,
    recording: &Recording,
    of: Functional,
    at: f64,
    warm: &[f64],
) -> (f64, Vec<f64>) {
    let model = match of {
        Functional::Gain => Model { gain: Some(at), ..estimate.model.clone() },
        _ => estimate.model.clone(),
    };
    let window = model.window(recording);
    let mut cost = |free: &[f64]| {
        let mut coordinates = free.to_vec();
        match of {
            Functional::Coordinate(i) => coordinates.insert(i, at),
            Functional::Sum => {
                let first = at - free[0].abs();
                if first < 0.0 {
                    return f64::INFINITY;
                }
                coordinates.insert(0, first);
            }
            Functional::Gain => {}
        }
        model.cost(window, &coordinates)
    };
    let mut scales = model.shape_scales(&estimate.point.shape, 0.3 * model.interval);
    scales.extend(model.noise_start().1);
    let scales = others(&scales, of);
    let scales: Vec<f64> = scales.iter().map(|scale| 0.3 * scale).collect();
    let found = simplex(&mut cost, warm, &scales, 10.0 * TOLERANCE);
    (found.value, found.point)
}
