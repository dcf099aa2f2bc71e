//! The result of an identification.

use libration_work::Work;
use serde::Serialize;

use crate::arrivals::median_period;
use crate::bootstrap::{self, BootstrapRow};
use crate::candidate::{ArrivalRow, CandidateRow};
use crate::estimate::Estimate;
use crate::excitation::{ExcitationRow, excitations};
use crate::hold::Hold;
use crate::information::{Information, information};
use crate::interval::{Functional, Interval, profile_interval};
use crate::likelihood_map::{LikelihoodMap, likelihood_map};
use crate::noise::NoiseKind;
use crate::recording::Recording;
use crate::request::{IdentifyError, Request};
use crate::residuals::ResidualTests;
use crate::selection::{Selection, select};
use crate::{summary, warnings};

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

/// How the response follows the command over time.
#[derive(Clone, Debug, Serialize)]
pub struct FitSeries {
    /// Times of the responses from the first command, in s.
    pub time: Vec<f64>,
    /// The responses.
    pub response: Vec<f64>,
    /// The response of the model to the commands alone.
    pub model: Vec<f64>,
    /// Innovations over their standard deviation.
    pub residual: Vec<f64>,
}

/// What a recording tells of a loop.
#[derive(Clone, Debug, Serialize)]
pub struct Identification {
    /// The answer in words.
    pub answer: String,
    /// What restricts it.
    pub warnings: Vec<String>,
    /// The name of the form of the response.
    pub response: &'static str,
    /// What the receiver makes of commands between their times.
    pub hold: Hold,
    /// The kind of noise.
    pub noise: NoiseKind,
    /// Dead time, lag, their sum, gain, load and noise.
    pub parameters: Vec<Estimated>,
    /// The correlation of the errors of dead time and lag; `null` without a lag.
    pub correlation: Option<f64>,
    /// Tests of the residuals.
    pub residuals: ResidualTests,
    /// Whether the residuals contradict the model, so that its intervals cannot be trusted.
    pub is_contradicted: bool,
    /// All tried forms, the best first.
    pub candidates: Vec<CandidateRow>,
    /// Laws of the arrivals of commands, the best first.
    pub arrivals: Vec<ArrivalRow>,
    /// What simulated recordings of the fit give.
    pub bootstrap: Vec<BootstrapRow>,
    /// What other commands would tell.
    pub excitations: Vec<ExcitationRow>,
    /// The likelihood over dead time and lag.
    pub likelihood: Option<LikelihoodMap>,
    /// The fit over time; at most 4000 responses.
    pub fit: FitSeries,
    /// The number of commands.
    pub commands: usize,
    /// The number of responses that were used.
    pub responses: usize,
    /// The median time between commands, in s.
    pub period: f64,
    /// The median time between responses, in s.
    pub interval: f64,
    /// The largest dead time that was tried, in s.
    pub largest_dead_time: f64,
    /// A command that repeats this identification.
    pub repeat_command: String,
    /// The version of Libration.
    pub libration_version: &'static str,
}

impl Identification {
    /// The parameter of this key.
    pub fn parameter(&self, key: &str) -> Option<&Estimated> {
        self.parameters.iter().find(|parameter| parameter.key == key)
    }
}

/// Most responses of a fit over time.
const MOST_SHOWN: usize = 4000;

/// Identifies a loop from a recording.
///
/// # Errors
/// [`IdentifyError`].
pub fn identify(
    recording: &Recording,
    request: &Request,
    work: &Work<'_>,
) -> Result<Identification, IdentifyError> {
    let largest = request.check(recording)?;
    let Selection { estimate, candidates, arrivals, best_arrival } =
        select(recording, request, largest, work)?;
    let information = information(&estimate, recording);
    let mut parameters = shape_parameters(&estimate, recording, information.as_ref());
    parameters.extend(linear_parameters(&estimate, information.as_ref()));
    parameters.extend(noise_parameters(&estimate));
    if let Some(fit) = &best_arrival {
        parameters.extend(fit.clone());
    }
    let count = request.bootstrap;
    let repeats = bootstrap::bootstrap(&estimate, recording, count, request.seed, work)?;
    let bootstrap = bootstrap_rows(&estimate, &repeats, &parameters);
    let correlation = correlation(&estimate, information.as_ref());
    let residuals = ResidualTests::new(&estimate, recording);
    let mut found = Identification {
        answer: String::new(),
        warnings: Vec::new(),
        response: estimate.model.response.name(),
        hold: estimate.model.hold,
        noise: estimate.model.noise,
        correlation,
        is_contradicted: residuals.contradict(),
        residuals,
        candidates,
        arrivals,
        bootstrap,
        excitations: excitations(&estimate, recording),
        likelihood: map(&estimate, recording, &parameters),
        parameters,
        fit: fit(&estimate, recording),
        commands: recording.commands.len(),
        responses: estimate.regression.residuals.len(),
        period: median_period(recording),
        interval: estimate.model.interval,
        largest_dead_time: largest,
        repeat_command: String::new(),
        libration_version: env!("CARGO_PKG_VERSION"),
    };
    found.warnings = warnings::warnings(&found, &estimate, recording);
    found.answer = summary::answer(&found);
    Ok(found)
}

/// Parameters of the response with their intervals, and the latency at low frequencies.
fn shape_parameters(
    estimate: &Estimate,
    recording: &Recording,
    information: Option<&Information>,
) -> Vec<Estimated> {
    let model = &estimate.model;
    let deviation = |i: usize| information.map(|found| found.covariance[(i, i)].sqrt());
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
            value: estimate.point.shape[i],
            interval,
            standard_error,
        });
    }
    parameters.extend(latency(estimate, recording, information));
    parameters
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
fn linear_parameters(estimate: &Estimate, information: Option<&Information>) -> Vec<Estimated> {
    let coordinates = estimate.model.coordinates();
    let error = |column: usize| {
        let found = information?;
        let place = found.coefficients.iter().position(|&other| other == column)?;
        let place = coordinates + place;
        Some(found.covariance[(place, place)].sqrt())
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
        .collect()
}

/// Standard deviations of the noise, and the jitter of arrivals.
fn noise_parameters(estimate: &Estimate) -> Vec<Estimated> {
    let (noise, variance) = (estimate.point.noise, estimate.variance());
    let row = |key: &str, name: &str, unit: &str, value: f64| Estimated {
        key: key.to_owned(),
        name: name.to_owned(),
        unit: unit.to_owned(),
        value,
        interval: None,
        standard_error: None,
    };
    let mut rows = vec![row("noise_std", "white noise", "", estimate.white_deviation())];
    if noise.coloured > 0.0 {
        rows.push(row("coloured_std", "coloured noise", "", (variance * noise.coloured).sqrt()));
        rows.push(row("correlation_time", "its correlation time", "s", noise.correlation_time));
    }
    if noise.disturbance > 0.0 {
        let intensity = (variance * noise.disturbance).sqrt();
        rows.push(row("disturbance", "disturbance at the input", "√s", intensity));
    }
    rows
}

fn correlation(estimate: &Estimate, information: Option<&Information>) -> Option<f64> {
    if estimate.model.free_shape() < 2 || estimate.model.known[0].is_some() {
        return None;
    }
    let covariance = &information?.covariance;
    Some(covariance[(0, 1)] / (covariance[(0, 0)] * covariance[(1, 1)]).sqrt())
}

fn bootstrap_rows(
    estimate: &Estimate,
    repeats: &[Vec<f64>],
    parameters: &[Estimated],
) -> Vec<BootstrapRow> {
    let names = estimate.model.response.parameters().iter().map(|parameter| parameter.key);
    let is_known = |i: usize| estimate.model.known.get(i).is_some_and(Option::is_some);
    names
        .chain(["gain"])
        .enumerate()
        .filter(|&(i, key)| !is_known(i) && !(key == "gain" && estimate.model.gain.is_some()))
        .filter_map(|(i, key)| {
            let values = repeats.iter().map(|values| values[i]).collect();
            let found = parameters.iter().find(|parameter| parameter.key == key);
            bootstrap::row(key, values, found.and_then(|parameter| parameter.standard_error))
        })
        .collect()
}

/// The likelihood around the intervals of the first two parameters, if both are free.
fn map(
    estimate: &Estimate,
    recording: &Recording,
    parameters: &[Estimated],
) -> Option<LikelihoodMap> {
    if estimate.model.free_shape() < 2 || estimate.model.known.iter().any(Option::is_some) {
        return None;
    }
    let range = |parameter: &Estimated| {
        let interval = parameter.interval?;
        let high = interval.high.unwrap_or(2.0 * parameter.value + estimate.model.interval);
        let width = (high - interval.low).max(1e-9 * estimate.model.interval);
        Some(((interval.low - 0.6 * width).max(0.0), high + 0.6 * width))
    };
    Some(likelihood_map(estimate, recording, [range(&parameters[0])?, range(&parameters[1])?]))
}

fn fit(estimate: &Estimate, recording: &Recording) -> FitSeries {
    let window = estimate.model.window(recording);
    let count = (recording.responses.len() - window.first).min(MOST_SHOWN);
    let end = window.first + count;
    let part = Recording {
        response_times: recording.response_times[window.first..end].to_vec(),
        responses: recording.responses[window.first..end].to_vec(),
        ..recording.clone()
    };
    let quiet = bootstrap::simulated(estimate).without_noise();
    let mean_square = estimate.variance().sqrt();
    FitSeries {
        model: quiet.responses(&part, 0, 0),
        time: part.response_times,
        response: part.responses,
        residual: estimate.regression.residuals[..count].iter().map(|x| x / mean_square).collect(),
    }
}
