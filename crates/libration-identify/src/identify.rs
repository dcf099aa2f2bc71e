//! Identification of a loop.

use libration_report::Verdict;
use libration_report::notation::plural;
use libration_work::Work;

use crate::arrival_parameters::arrival_parameters;
use crate::arrivals::{ArrivalFit, ArrivalLaw, ArrivalSearch, median_period};
use crate::bootstrap::{self, BootstrapRow};
use crate::dependence::Dependence;
use crate::effort::{Effort, default_evaluations};
use crate::estimate::{Estimate, busiest};
use crate::excitation::excitations;
use crate::identification::{FitSeries, Identification, StateSpace};
use crate::information::{Information, information};
use crate::interval::{Functional, profile_interval};
use crate::likelihood_map::{LikelihoodMap, likelihood_map};
use crate::linearity::LinearityTests;
use crate::parameters::{Estimated, certain_parameters};
use crate::recording::Recording;
use crate::request::{IdentifyError, Request};
use crate::residuals::ResidualTests;
use crate::rival_dead_times::rival_dead_times;
use crate::selection::{Selection, select};
use crate::start::{Start, likely_start};
use crate::task::Task;
use crate::verdict::verdict;
use crate::{summary, warnings};

/// Most responses of a fit: of a longer recording, those during which the command changes most.
const MOST_USED: usize = 10_000;
/// The largest share of commands that may be missing from a log.
const MOST_MISSING: f64 = 0.05;
/// The longest lead of a response that is looked for, in intervals of the responses.
const LONGEST_LEAD: f64 = 20.0;
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
    let (largest, mut start) = request.check(recording)?;
    let all = recording.responses.len();
    let first = busiest(recording, 0, MOST_USED);
    let excerpt = (all > MOST_USED).then(|| recording.excerpt(first, MOST_USED, largest));
    let is_free = request.start.is_none_or(|start| start == Start::Rest);
    if let Some(excerpt) = excerpt.as_ref().filter(|_| first > 0 && is_free) {
        // The whole recording has the commands before its excerpt.
        start = likely_start(excerpt, largest);
    }
    let recording = excerpt.as_ref().unwrap_or(recording);
    let evaluations = request
        .budget
        .map_or_else(|| default_evaluations(recording.responses.len()), |budget| budget as u64);
    let task = Task { recording, request, largest, evaluations, work: *work };
    let Selection { estimate, arrivals, candidates, lag, dependence, mut not_examined } =
        select(task, start)?;
    let window = estimate.model.window(recording);
    let unlimited = estimate.with_effort(Effort::unlimited(*work));
    let search = arrivals
        .as_ref()
        .and_then(|fit| Some((fit, ArrivalSearch::new(fit.law, &unlimited, recording)?)));
    let information = information(&estimate, recording);
    let scores = search.as_ref().map(|(fit, search)| search.scores(fit));
    let linearity = LinearityTests::of(&estimate, recording, scores.as_deref());
    let (parameters, residuals, correlation, bootstrap) = match &search {
        Some((fit, search)) => {
            let covariance = search.covariance(fit);
            let parameters = arrival_parameters(fit, &estimate.model, covariance.as_ref());
            let tests = ResidualTests::new(&search.scores(fit), 0, window.first, recording);
            (parameters, tests, None, Vec::new())
        }
        None => {
            let parameters = certain_parameters(&estimate, recording, information.as_ref(), work)?;
            let tests = ResidualTests::of(&estimate, recording);
            let count = request.bootstrap;
            let repeats = bootstrap::bootstrap(&estimate, recording, count, request.seed, work)?;
            let bootstrap = bootstrap_rows(&estimate, &repeats, &parameters);
            (parameters, tests, correlation(&estimate, information.as_ref()), bootstrap)
        }
    };
    work.check()?;
    let is_detailed = request.details && search.is_none();
    let mut found = Identification {
        answer: String::new(),
        verdict: Verdict::unknown(""),
        warnings: Vec::new(),
        response: estimate.model.response.name(),
        hold: estimate.model.hold,
        noise: estimate.model.noise,
        arrivals: arrivals.as_ref().map_or(ArrivalLaw::Certain, |fit| fit.law).name(),
        start: estimate.model.assumed_start(),
        correlation,
        is_contradicted: residuals.contradict()
            || linearity.contradict()
            || lacks_commands(recording),
        residuals,
        linearity,
        other_dead_times: Vec::new(),
        candidates,
        bootstrap,
        excitations: if is_detailed { excitations(&estimate, recording) } else { Vec::new() },
        likelihood: is_detailed.then(|| map(&estimate, recording, &parameters)).flatten(),
        fit: fit(&estimate, recording, scores.as_deref()),
        parameters,
        commands: recording.commands.len(),
        responses: estimate.regression.residuals.len(),
        depends_on_command: dependence == Dependence::Shown,
        delay_range: None,
        state_space: state_space(&estimate, arrivals.as_ref()),
        period: median_period(recording),
        interval: estimate.model.interval,
        largest_dead_time: largest,
        budget: evaluations,
        repeat_command: String::new(),
        libration_version: env!("CARGO_PKG_VERSION"),
    };
    let longest_lag = match estimate.model.response.name() {
        "delay" => lag.and_then(|lag| longest_lag(&lag, recording)),
        _ => None,
    };
    let lead = lead(&estimate, recording);
    let interval = found.parameter("dead_time").and_then(|parameter| parameter.interval);
    let rivals = match found.depends_on_command {
        true => rival_dead_times(&estimate, interval, recording),
        false => Some(Vec::new()),
    };
    if rivals.is_none() {
        not_examined.push(format!("other dead times (budget of {evaluations} evaluations)"));
    }
    found.other_dead_times = rivals.unwrap_or_default();
    work.check()?;
    let context = warnings::Context { estimate: &estimate, recording, all, longest_lag, lead };
    let unprofiled = found.parameters.iter().filter(|parameter| parameter.is_unprofiled);
    not_examined.extend(unprofiled.map(|parameter| {
        let name = &parameter.name;
        format!("the likelihood over the {name} (budget of {evaluations} evaluations)")
    }));
    if window.first > 0 {
        let dropped = plural(window.first, "response");
        let dead_time = summary::seconds(largest);
        not_examined
            .push(format!("the first {dropped}, up to the largest dead time of {dead_time}"));
    }
    if estimate.model.known[0].is_none()
        && let Some(period) = warnings::period(recording).filter(|&period| period > largest)
    {
        let period = summary::seconds(period);
        not_examined.push(format!(
            "dead times above {}, of which the command repeats itself every {period}",
            summary::seconds(largest)
        ));
    }
    if found.depends_on_command && found.linearity.command_levels.is_none() {
        not_examined.push(
            "whether the response is proportional to the command, which has too few levels"
                .to_owned(),
        );
    }
    found.verdict = verdict(&found, &dependence, &context, not_examined);
    found.warnings = warnings::warnings(&found, &context);
    let is_good = found.has_intervals();
    found.parameters.iter_mut().for_each(|parameter| parameter.judge(is_good));
    found.delay_range = found.dead_times(estimate.model.known[0]).filter(|_| is_good);
    found.answer = summary::answer(&found);
    Ok(found)
}

/// The longest lag that a recording of a dead time alone does not exclude.
fn longest_lag(fit: &Estimate<'_>, recording: &Recording) -> Option<f64> {
    let place = fit.coordinates.len().checked_sub(1).filter(|_| fit.model.known[1].is_none())?;
    profile_interval(fit, recording, Functional::Coordinate(place), None)?.high
}

/// Whether so many commands are missing from the log that no model can be right.
fn lacks_commands(recording: &Recording) -> bool {
    recording.missing_commands() as f64 > MOST_MISSING * recording.commands.len() as f64
}

/// By how much the response leads the command, in s, if a dead time of zero is not early enough.
fn lead(estimate: &Estimate<'_>, recording: &Recording) -> Option<f64> {
    let model = &estimate.model;
    let is_at_zero = estimate.point.shape[0] < 0.02 * model.interval;
    if !is_at_zero || model.known[0].is_some() {
        return None;
    }
    // The same responses, logged later: a lead is then a dead time that is shorter than this.
    let later = (LONGEST_LEAD * model.interval).min(0.5 * model.longest);
    let shifted = Recording {
        response_times: recording.response_times.iter().map(|time| time + later).collect(),
        ..recording.clone()
    };
    let model = &model.with_effort(model.effort.renewed(1));
    let fit = Estimate::search(model, &shifted)?;
    let interval = profile_interval(&fit, &shifted, Functional::Coordinate(0), None)?;
    let lead = later - fit.point.shape[0];
    interval.high.filter(|&high| high < later - 0.1 * model.interval).map(|_| lead)
}

/// The matrices of the plant behind the dead time, with its gain.
fn state_space(estimate: &Estimate<'_>, arrivals: Option<&ArrivalFit>) -> StateSpace {
    let (shape, gain) = match arrivals {
        Some(fit) => (&fit.model.shape, fit.model.gain),
        None => (&estimate.point.shape, estimate.regression.coefficients[0]),
    };
    let plant = estimate.model.response.dynamics(&shape[1..]);
    StateSpace {
        a: (0..plant.states()).map(|i| plant.a.row(i).to_vec()).collect(),
        b: plant.b.iter().map(|b| gain * b).collect(),
        c: plant.c.clone(),
        d: gain * plant.d,
    }
}

fn correlation(estimate: &Estimate<'_>, information: Option<&Information>) -> Option<f64> {
    if estimate.model.free_shape() < 2 || estimate.model.known[0].is_some() {
        return None;
    }
    let covariance = &information?.covariance;
    let correlation = covariance[(0, 1)] / (covariance[(0, 0)] * covariance[(1, 1)]).sqrt();
    Some(correlation).filter(|correlation| correlation.is_finite())
}

fn bootstrap_rows(
    estimate: &Estimate<'_>,
    repeats: &[Vec<f64>],
    parameters: &[Estimated],
) -> Vec<BootstrapRow> {
    let names = estimate.model.response.parameters().iter().map(|parameter| parameter.key);
    let is_known = |i: usize| estimate.model.known.get(i).is_some_and(Option::is_some);
    names
        .chain(["gain"])
        .enumerate()
        .filter(|&(i, key)| !is_known(i) && (key != "gain" || estimate.model.gain.is_none()))
        .filter_map(|(i, key)| {
            let values = repeats.iter().map(|values| values[i]).collect();
            let found = parameters.iter().find(|parameter| parameter.key == key);
            bootstrap::row(key, values, found.and_then(|parameter| parameter.standard_error))
        })
        .collect()
}

/// The likelihood around the intervals of the first two parameters, if both are free.
fn map(
    estimate: &Estimate<'_>,
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

fn fit(estimate: &Estimate<'_>, recording: &Recording, scores: Option<&[f64]>) -> FitSeries {
    let window = estimate.model.window(recording);
    let count = (recording.responses.len() - window.first).min(MOST_SHOWN);
    let end = window.first + count;
    let part = Recording {
        response_times: recording.response_times[window.first..end].to_vec(),
        responses: recording.responses[window.first..end].to_vec(),
        ..recording.clone()
    };
    let quiet = bootstrap::simulated(estimate, recording).without_noise();
    let deviation = estimate.variance().sqrt();
    let own: Vec<f64> = estimate.regression.residuals.iter().map(|x| x / deviation).collect();
    FitSeries {
        model: quiet.responses(&part, 0, 0),
        time: part.response_times,
        response: part.responses,
        residual: scores.unwrap_or(&own)[..count].to_vec(),
    }
}
