//! Parameters of a fit in which all commands arrive.

use serde::Serialize;

use crate::estimate::Estimate;
use crate::hold::Hold;
use crate::information::Information;
use crate::interval::{Functional, Interval, profile_interval};
use crate::recording::Recording;

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
    /// The 95 % interval; `null` for a number that was given.
    pub interval: Option<Interval>,
    /// The standard error by Fisher's information; `null` if it has none.
    pub standard_error: Option<f64>,
}

impl Estimated {
    /// A number without an interval.
    pub(crate) fn plain(key: &str, name: &str, unit: &str, value: f64) -> Self {
        Estimated {
            key: key.to_owned(),
            name: name.to_owned(),
            unit: unit.to_owned(),
            value,
            interval: None,
            standard_error: None,
        }
    }
}

/// All parameters.
pub(crate) fn certain_parameters(
    estimate: &Estimate,
    recording: &Recording,
    information: Option<&Information>,
) -> Vec<Estimated> {
    let mut parameters = shape_parameters(estimate, recording, information);
    parameters.extend(linear_parameters(estimate, recording, information));
    parameters.extend(noise_parameters(estimate));
    parameters
}

/// Parameters of the response with their intervals, and the latency at low frequencies.
fn shape_parameters(
    estimate: &Estimate,
    recording: &Recording,
    information: Option<&Information>,
) -> Vec<Estimated> {
    let model = &estimate.model;
    let deviation = |i: usize| {
        information.map(|found| found.covariance[(i, i)].sqrt()).filter(|x| x.is_finite())
    };
    let mut free = 0;
    let mut parameters = Vec::new();
    for (i, parameter) in model.response.parameters().iter().enumerate() {
        let is_known = model.known[i].is_some();
        let standard_error = if is_known { None } else { deviation(free) };
        let interval = (!is_known).then(|| {
            profile_interval(estimate, recording, Functional::Coordinate(free), standard_error)
        });
        free += usize::from(!is_known);
        parameters.push(Estimated {
            key: parameter.key.to_owned(),
            name: parameter.name.to_owned(),
            unit: parameter.unit.to_owned(),
            value: middle(estimate, interval).unwrap_or(estimate.point.shape[i]),
            interval,
            standard_error,
        });
    }
    parameters.extend(latency(estimate, recording, information));
    parameters
}

/// The middle of the interval of a dead time alone, over which the likelihood is the same.
fn middle(estimate: &Estimate, interval: Option<Interval>) -> Option<f64> {
    let is_flat =
        estimate.model.response.parameters().len() == 1 && estimate.model.hold == Hold::Zero;
    interval.filter(|_| is_flat).and_then(|interval| Some(0.5 * (interval.low + interval.high?)))
}

/// The delay of slow commands: of a lag its time constant, of a response of second order `2ζ/ω`.
fn latency(
    estimate: &Estimate,
    recording: &Recording,
    information: Option<&Information>,
) -> Option<Estimated> {
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
    let interval = match shape.len() {
        2 => Some(profile_interval(estimate, recording, Functional::Sum, standard_error)),
        _ => standard_error.map(|error| normal_interval(value, error, estimate)),
    };
    Some(Estimated {
        key: "latency".to_owned(),
        name: "latency of slow commands".to_owned(),
        unit: "s".to_owned(),
        value,
        interval,
        standard_error,
    })
}

fn normal_interval(value: f64, error: f64, estimate: &Estimate) -> Interval {
    let freedom = estimate.regression.residuals.len() as f64 - estimate.parameters() as f64;
    let half = crate::quantiles::student(freedom) * error;
    Interval { low: value - half, high: Some(value + half) }
}

/// Gain and load.
fn linear_parameters(
    estimate: &Estimate,
    recording: &Recording,
    information: Option<&Information>,
) -> Vec<Estimated> {
    let coordinates = estimate.model.coordinates();
    let error = |column: usize| {
        let found = information?;
        let place = found.coefficients.iter().position(|&other| other == column)?;
        let place = coordinates + place;
        Some(found.covariance[(place, place)].sqrt()).filter(|error| error.is_finite())
    };
    [("gain", "gain", 0), ("load", "constant load at the input", 1)]
        .into_iter()
        .map(|(key, name, column)| {
            let value = estimate.regression.coefficients[column];
            let standard_error = error(column);
            Estimated {
                key: key.to_owned(),
                name: name.to_owned(),
                unit: String::new(),
                value,
                interval: standard_error.map(|error| normal_interval(value, error, estimate)),
                standard_error,
            }
        })
        .map(|row| match row.key == "gain" && estimate.model.gain.is_none() {
            true => Estimated { interval: gain_interval(estimate, recording, &row), ..row },
            false => row,
        })
        .collect()
}

/// The interval of the gain: with noise of which the colour is fitted too, the normal one is too narrow.
fn gain_interval(estimate: &Estimate, recording: &Recording, row: &Estimated) -> Option<Interval> {
    let first = row.standard_error.unwrap_or(0.01 * row.value.abs());
    let profile = profile_interval(estimate, recording, Functional::Gain, Some(first));
    let is_whole = profile.high.is_some() && profile.low.is_finite();
    if is_whole { Some(profile) } else { row.interval }
}

/// Standard deviations of the noise.
fn noise_parameters(estimate: &Estimate) -> Vec<Estimated> {
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
