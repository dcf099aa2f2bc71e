//! The result of an identification.

use libration_work::Work;
use serde::Serialize;

use crate::arrival_parameters::arrival_parameters;
use crate::arrivals::{ArrivalSearch, median_period};
use crate::bootstrap::{self, BootstrapRow};
use crate::candidate::CandidateRow;
use crate::estimate::Estimate;
use crate::excitation::{ExcitationRow, excitations};
use crate::hold::Hold;
use crate::information::{Information, information};
use crate::likelihood_map::{LikelihoodMap, likelihood_map};
use crate::noise::NoiseKind;
use crate::parameters::{Estimated, certain_parameters};
use crate::recording::Recording;
use crate::request::{IdentifyError, Request};
use crate::residuals::ResidualTests;
use crate::selection::{Selection, select};
use crate::{summary, warnings};

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
    /// How commands arrive: `certain`, `jitter`, `loss` or `two-delays`.
    pub arrivals: &'static str,
    /// Dead time, lag, their sum, gain, load and noise.
    pub parameters: Vec<Estimated>,
    /// The correlation of the errors of dead time and lag; `null` without a lag.
    pub correlation: Option<f64>,
    /// Tests of the residuals.
    pub residuals: ResidualTests,
    /// Whether the residuals contradict the model, so that its intervals cannot be trusted.
    pub is_contradicted: bool,
    /// All tried models, the best first.
    pub candidates: Vec<CandidateRow>,
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
    let Selection { estimate, arrivals, candidates } = select(recording, request, largest, work)?;
    let window = estimate.model.window(recording);
    let search = arrivals
        .as_ref()
        .and_then(|fit| Some((fit, ArrivalSearch::new(fit.law, &estimate, recording)?)));
    let information = information(&estimate, recording);
    let (parameters, residuals, correlation, bootstrap) = match &search {
        Some((fit, search)) => {
            let covariance = search.covariance(fit);
            let changes = recording.commands.windows(2).filter(|pair| pair[0] != pair[1]).count();
            let parameters = arrival_parameters(fit, &estimate.model, covariance.as_ref(), changes);
            let tests = ResidualTests::new(&search.scores(fit), 0, window.first, recording);
            (parameters, tests, None, Vec::new())
        }
        None => {
            let parameters = certain_parameters(&estimate, recording, information.as_ref());
            let tests = ResidualTests::of(&estimate, recording);
            let count = request.bootstrap;
            let repeats = bootstrap::bootstrap(&estimate, recording, count, request.seed, work)?;
            let bootstrap = bootstrap_rows(&estimate, &repeats, &parameters);
            (parameters, tests, correlation(&estimate, information.as_ref()), bootstrap)
        }
    };
    let is_certain = search.is_none();
    let mut found = Identification {
        answer: String::new(),
        warnings: Vec::new(),
        response: estimate.model.response.name(),
        hold: estimate.model.hold,
        noise: estimate.model.noise,
        arrivals: candidates.first().map_or("certain", |row| row.arrivals),
        correlation,
        is_contradicted: residuals.contradict(),
        residuals,
        candidates,
        bootstrap,
        excitations: if is_certain { excitations(&estimate, recording) } else { Vec::new() },
        likelihood: is_certain.then(|| map(&estimate, recording, &parameters)).flatten(),
        fit: match &search {
            None => fit(&estimate, recording, None),
            Some((fit, search)) => self::fit(&estimate, recording, Some(&search.scores(fit))),
        },
        parameters,
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

fn fit(estimate: &Estimate, recording: &Recording, scores: Option<&[f64]>) -> FitSeries {
    let window = estimate.model.window(recording);
    let count = (recording.responses.len() - window.first).min(MOST_SHOWN);
    let end = window.first + count;
    let part = Recording {
        response_times: recording.response_times[window.first..end].to_vec(),
        responses: recording.responses[window.first..end].to_vec(),
        ..recording.clone()
    };
    let quiet = bootstrap::simulated(estimate).without_noise();
    let deviation = estimate.variance().sqrt();
    let own: Vec<f64> = estimate.regression.residuals.iter().map(|x| x / deviation).collect();
    FitSeries {
        model: quiet.responses(&part, 0, 0),
        time: part.response_times,
        response: part.responses,
        residual: scores.unwrap_or(&own)[..count].to_vec(),
    }
}
