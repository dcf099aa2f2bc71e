//! Parameters of a fit in which all commands arrive.

use libration_work::{Interrupted, Work};
use serde::Serialize;

use crate::estimate::Estimate;
use crate::hold::Hold;
use crate::information::Information;
use crate::interval::{Functional, Interval, profile_interval};
use crate::recording::Recording;
use crate::whitening::COMMAND;

/// A number that was identified.
#[derive(Clone, Debug, Serialize)]
pub struct Estimated {
    /// The key in results.
    pub key: String,
    /// The name in sentences.
    pub name: String,
    /// The unit; empty if there is none.
    pub unit: String,
    /// The estimate of greatest likelihood.
    pub value: f64,
    /// The 95 % interval; `null` for a number that was given, and where the verdict is not good.
    pub interval: Option<Interval>,
    /// The interval of the likelihood, which has this level only if the model is the right one.
    pub likelihood_interval: Option<Interval>,
    /// The standard error by Fisher's information; `null` if it has none.
    pub standard_error: Option<f64>,
    /// Whether the interval is no profile of the likelihood, since its effort ended before.
    #[serde(skip)]
    pub(crate) is_unprofiled: bool,
}

impl Estimated {
    /// States the interval at its level only with a good verdict.
    pub(crate) fn judge(&mut self, is_good: bool) {
        self.likelihood_interval = self.interval;
        self.interval = self.interval.filter(|_| is_good);
    }

    /// A number without an interval.
    pub(crate) fn plain(key: &str, name: &str, unit: &str, value: f64) -> Self {
        Estimated {
            key: key.to_owned(),
            name: name.to_owned(),
            unit: unit.to_owned(),
            value,
            interval: None,
            likelihood_interval: None,
            standard_error: None,
            is_unprofiled: false,
        }
    }
}

/// All parameters.
///
/// # Errors
/// [`Interrupted`].
pub(crate) fn certain_parameters(
    estimate: &Estimate<'_>,
    recording: &Recording,
    information: Option<&Information>,
    work: &Work<'_>,
) -> Result<Vec<Estimated>, Interrupted> {
    let mut rows = shape_parameters(estimate, information);
    rows.extend(latency(estimate, information));
    rows.extend(linear_parameters(estimate, information));
    let rows = work.sweep("intervals", &rows, |(row, of)| {
        Ok::<_, Interrupted>(match of {
            Some(of) => profiled(row, *of, estimate, recording),
            None => row.clone(),
        })
    })?;
    Ok(rows.into_iter().chain(noise_parameters(estimate)).collect())
}

/// A parameter, and of what its interval is the profile.
type Row = (Estimated, Option<Functional>);

/// The parameter with its profile. Of a gain whose profile has no end, and where the effort ends first, the normal interval is left.
fn profiled(
    row: &Estimated,
    of: Functional,
    estimate: &Estimate<'_>,
    recording: &Recording,
) -> Estimated {
    let first = match of {
        Functional::Gain => row.standard_error.or(Some(0.01 * row.value.abs())),
        _ => row.standard_error,
    };
    let Some(profile) = profile_interval(estimate, recording, of, first) else {
        let least = if of == Functional::Gain { f64::NEG_INFINITY } else { 0.0 };
        let normal = row.standard_error.map(|error| normal_interval(row.value, error, estimate));
        let interval = normal.map(|found| Interval { low: found.low.max(least), ..found });
        return Estimated { interval, is_unprofiled: true, ..row.clone() };
    };
    let is_whole = profile.high.is_some() && profile.low.is_finite();
    let interval = match of == Functional::Gain && !is_whole {
        true => row.interval,
        false => Some(profile),
    };
    let is_dead_time = of == Functional::Coordinate(0) && row.key == "dead_time";
    let middle = if is_dead_time { middle(estimate, interval) } else { None };
    Estimated { value: middle.unwrap_or(row.value), interval, ..row.clone() }
}

/// Parameters of the response.
fn shape_parameters(estimate: &Estimate<'_>, information: Option<&Information>) -> Vec<Row> {
    let model = &estimate.model;
    let deviation = |i: usize| {
        information.map(|found| found.covariance[(i, i)].sqrt()).filter(|x| x.is_finite())
    };
    let mut free = 0;
    let mut rows = Vec::new();
    for (i, parameter) in model.response.parameters().iter().enumerate() {
        let is_known = model.known[i].is_some();
        let value = estimate.point.shape[i];
        let row = Estimated {
            standard_error: if is_known { None } else { deviation(free) },
            ..Estimated::plain(parameter.key, parameter.name, parameter.unit, value)
        };
        rows.push((row, (!is_known).then_some(Functional::Coordinate(free))));
        free += usize::from(!is_known);
    }
    rows
}

/// The middle of the interval of a dead time alone, over which the likelihood is the same.
fn middle(estimate: &Estimate<'_>, interval: Option<Interval>) -> Option<f64> {
    let is_flat =
        estimate.model.response.parameters().len() == 1 && estimate.model.hold == Hold::Zero;
    interval.filter(|_| is_flat).and_then(|interval| Some(0.5 * (interval.low + interval.high?)))
}

/// The delay of slow commands: of a lag its time constant, of a response of second order `2ζ/ω`.
fn latency(estimate: &Estimate<'_>, information: Option<&Information>) -> Option<Row> {
    let (model, shape) = (&estimate.model, &estimate.point.shape);
    if model.free_shape() != shape.len() || shape.len() < 2 {
        return None;
    }
    let gradient = match shape.len() {
        2 => vec![1.0, 1.0],
        _ => vec![1.0, 2.0 * shape[2], 2.0 * shape[1]],
    };
    let value = shape[0] + if shape.len() == 2 { shape[1] } else { 2.0 * shape[1] * shape[2] };
    let standard_error = information.map(|found| {
        let product = |i: usize, j: usize| gradient[i] * found.covariance[(i, j)] * gradient[j];
        (0..shape.len())
            .map(|i| (0..shape.len()).map(|j| product(i, j)).sum::<f64>())
            .sum::<f64>()
            .sqrt()
    });
    let standard_error = standard_error.filter(|error| error.is_finite());
    let row = Estimated {
        standard_error,
        ..Estimated::plain("latency", "latency of slow commands", "s", value)
    };
    Some(match shape.len() {
        2 => (row, Some(Functional::Sum)),
        _ => {
            let interval = standard_error.map(|error| normal_interval(value, error, estimate));
            (Estimated { interval, ..row }, None)
        }
    })
}

fn normal_interval(value: f64, error: f64, estimate: &Estimate<'_>) -> Interval {
    let freedom = estimate.regression.residuals.len() as f64 - estimate.parameters() as f64;
    let half = crate::quantiles::student(freedom) * error;
    Interval { low: value - half, high: Some(value + half) }
}

/// Gain and load.
fn linear_parameters(estimate: &Estimate<'_>, information: Option<&Information>) -> Vec<Row> {
    let coordinates = estimate.model.coordinates();
    let error = |column: usize| {
        let found = information?;
        let place = found.coefficients.iter().position(|&other| other == column)?;
        let place = coordinates + place;
        Some(found.covariance[(place, place)].sqrt()).filter(|error| error.is_finite())
    };
    let names = [("gain", "gain"), ("load", "constant load at the input")];
    let row = |(column, (key, name))| {
        let value = estimate.regression.coefficients[column];
        let standard_error = error(column);
        let interval = standard_error.map(|error| normal_interval(value, error, estimate));
        let row = Estimated { interval, standard_error, ..Estimated::plain(key, name, "", value) };
        // With noise of which the colour is fitted too, the normal interval of a gain is too narrow.
        let is_profiled = column == COMMAND && estimate.model.gain.is_none();
        (row, is_profiled.then_some(Functional::Gain))
    };
    names.into_iter().enumerate().map(row).collect()
}

/// Standard deviations of the noise.
fn noise_parameters(estimate: &Estimate<'_>) -> Vec<Estimated> {
    let (noise, variance) = (estimate.point.noise, estimate.variance());
    let mut rows =
        vec![Estimated::plain("noise_std", "white noise", "", estimate.white_deviation())];
    if noise.coloured > 0.0 {
        let deviation = (variance * noise.coloured).sqrt();
        rows.push(Estimated::plain("coloured_std", "coloured noise", "", deviation));
        let time = noise.correlation_time;
        rows.push(Estimated::plain("correlation_time", "its correlation time", "s", time));
    }
    if noise.disturbance > 0.0 {
        let intensity = (variance * noise.disturbance).sqrt();
        rows.push(Estimated::plain("disturbance", "disturbance at the input", "√s", intensity));
    }
    rows
}
