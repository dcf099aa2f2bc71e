//! The choice of a model.

use libration_work::Work;

use crate::arrivals::{ArrivalFit, ArrivalLaw, ArrivalSearch};
use crate::candidate::CandidateRow;
use crate::estimate::Estimate;
use crate::hold::Hold;
use crate::model::Model;
use crate::noise::NoiseKind;
use crate::recording::Recording;
use crate::request::{IdentifyError, Request};
use crate::residuals::ResidualTests;
use crate::response::ResponseKind;

/// The chosen model, and what was tried.
pub(crate) struct Selection {
    /// The best fit in which all commands arrive; with random arrivals, the one that they were searched from.
    pub(crate) estimate: Estimate,
    /// Random arrivals, if they are better.
    pub(crate) arrivals: Option<ArrivalFit>,
    /// All models, the best first.
    pub(crate) candidates: Vec<CandidateRow>,
    /// The best fit of a lag of first order with white noise.
    pub(crate) lag: Option<Estimate>,
    /// Whether the response depends on the command.
    pub(crate) depends: bool,
}

/// Forms of response whose noise and arrivals are searched.
const PURSUED: usize = 3;

/// Models whose criterion is larger by more than this before they are fitted to all responses are not fitted to them.
const MAY_WIN: f64 = 60.0;

/// Forms of response with held commands whose arrivals are searched.
const HELD: usize = 2;

/// A gain in log likelihood that has a probability below 10⁻³ if one of a hundred independent dead times is chosen: `½χ²` at 10⁻⁵.
const BY_CHANCE: f64 = 9.8;

/// The model with the least criterion of Bayes: forms of response with white noise first, then noise and arrivals of the best of them.
pub(crate) fn select(
    recording: &Recording,
    request: &Request,
    largest: f64,
    work: &Work<'_>,
) -> Result<Selection, IdentifyError> {
    let models: Vec<Model> = request
        .responses
        .iter()
        .flat_map(|response| request.holds.iter().map(|&hold| (response.clone(), hold)))
        .map(|(response, hold)| model(response, hold, recording, request, largest))
        .collect();
    let searched = work.sweep("responses", &models, |model| {
        Ok::<_, IdentifyError>(Estimate::search(model, recording))
    })?;
    let mut searched: Vec<Estimate> = searched.into_iter().flatten().collect();
    by_criterion(&mut searched);
    // Receivers hold commands. Lines between them, half a period earlier, imitate a held command so well that any defect of a log makes
    // them the better model: they are chosen only on request.
    let is_asked =
        |fit: &&Estimate| !request.holds.contains(&Hold::Zero) || fit.model.hold == Hold::Zero;
    let lines: Vec<Estimate> = searched.iter().filter(|fit| !is_asked(fit)).cloned().collect();
    searched.retain(|fit| is_asked(&fit));
    let lag = searched.iter().find(|fit| fit.model.response.name() == "lag").cloned();
    let mut fits = with_noises(&searched, recording, request, work)?;
    let best = fits.first().ok_or(IdentifyError::NoFit)?;
    let depends = depends_on_command(best, recording);
    let is_suspect =
        best.model.noise != NoiseKind::White || ResidualTests::of(best, recording).are_suspect();
    let mut random = Vec::new();
    // A command that is missing from the log looks like one that is lost.
    if request.arrivals && is_suspect && depends && recording.missing_commands() == 0 {
        let held: Vec<&Estimate> =
            searched.iter().filter(|fit| fit.model.hold == Hold::Zero).take(HELD).collect();
        random = with_arrivals(&held, recording, work)?;
    }
    by_criterion(&mut fits);
    let mut candidates: Vec<CandidateRow> =
        fits.iter().chain(&lines).map(CandidateRow::certain).collect();
    let mut estimate = fits[0].clone();
    let mut arrivals = None;
    let mut least = estimate.criterion();
    for (base, fit, row) in random {
        if row.excess < least {
            least = row.excess;
            (estimate, arrivals) = (base, Some(fit));
        }
        candidates.push(row);
    }
    candidates.iter_mut().for_each(|row| row.excess -= least);
    candidates.sort_by(|a, b| a.excess.total_cmp(&b.excess));
    Ok(Selection { estimate, arrivals, candidates, lag, depends })
}

/// Whether a fit is better than one without the command, by more than a search over the dead time gains by chance.
fn depends_on_command(fit: &Estimate, recording: &Recording) -> bool {
    let model = Model { gain: Some(0.0), ..fit.model.clone() };
    // Of noise that is fitted again, without the command.
    let noise = &fit.coordinates[fit.model.free_shape()..];
    let start = [model.free(&fit.point.shape), noise.to_vec()].concat();
    let without = match noise.is_empty() {
        true => Estimate::at(&model, recording, &start),
        false => Estimate::from_start(&model, recording, &start, 0.2 * model.interval),
    };
    without.is_none_or(|without| fit.log_likelihood - without.log_likelihood > BY_CHANCE)
}

fn by_criterion(fits: &mut [Estimate]) {
    fits.sort_by(|a, b| a.criterion().total_cmp(&b.criterion()));
}

fn model(
    response: ResponseKind,
    hold: Hold,
    recording: &Recording,
    request: &Request,
    largest: f64,
) -> Model {
    let known = |key: &str| match key {
        "dead_time" => request.dead_time,
        "lag" => request.lag,
        _ => None,
    };
    Model {
        known: response.parameters().iter().map(|parameter| known(parameter.key)).collect(),
        // Without a disturbance, errors of an unstable plant would have grown beyond all bounds, and nothing would follow from its responses.
        noise: match request.noises.contains(&NoiseKind::Disturbance)
            && response.is_unstable(recording.span())
        {
            true => NoiseKind::Disturbance,
            false => NoiseKind::White,
        },
        response,
        hold,
        gain: request.gain,
        longest: largest,
        interval: recording.interval(),
    }
}

/// The fits with each kind of noise, the best first; of the best forms of response only, except with white noise.
fn with_noises(
    searched: &[Estimate],
    recording: &Recording,
    request: &Request,
    work: &Work<'_>,
) -> Result<Vec<Estimate>, IdentifyError> {
    let others = request.noises.iter().filter(|&&noise| noise != NoiseKind::White);
    let jobs: Vec<(&Estimate, NoiseKind)> = others
        .flat_map(|&noise| searched.iter().take(PURSUED).map(move |fit| (fit, noise)))
        // A disturbance of a plant without states is an error of the measurement.
        .filter(|(fit, noise)| *noise != NoiseKind::Disturbance || fit.has_states())
        .filter(|(fit, _)| fit.model.noise == NoiseKind::White)
        .collect();
    let found = work.sweep("noise", &jobs, |&(fit, noise)| {
        let model = Model { noise, ..fit.model.clone() };
        Ok::<_, IdentifyError>(fit.extended(&model, recording))
    })?;
    let mut fits: Vec<Estimate> = found.into_iter().flatten().collect();
    if request.noises.contains(&NoiseKind::White) || fits.is_empty() {
        fits.extend(searched.iter().cloned());
    }
    by_criterion(&mut fits);
    Ok(fits)
}

/// Jitter, losses and two delays, with white noise.
fn with_arrivals(
    held: &[&Estimate],
    recording: &Recording,
    work: &Work<'_>,
) -> Result<Vec<(Estimate, ArrivalFit, CandidateRow)>, IdentifyError> {
    let laws = ArrivalLaw::ALL;
    let jobs: Vec<(&Estimate, ArrivalLaw)> =
        held.iter().flat_map(|&base| laws.map(|law| (base, law))).collect();
    let rough = work.sweep("arrivals", &jobs, |&(base, law)| {
        let search = ArrivalSearch::new(law, base, recording);
        Ok::<_, IdentifyError>(search.and_then(|search| search.rough()))
    })?;
    // Only what may win is fitted to all responses.
    let count = |base: &Estimate| base.regression.residuals.len();
    let criteria: Vec<f64> = jobs
        .iter()
        .zip(&rough)
        .map(|((base, _), fit)| {
            fit.as_ref().map_or(f64::INFINITY, |fit| fit.criterion(count(base)))
        })
        .collect();
    let least = criteria.iter().copied().fold(f64::INFINITY, f64::min);
    let jobs: Vec<_> = jobs.into_iter().zip(rough).zip(criteria).collect();
    let found = work.sweep("arrivals", &jobs, |(((base, law), fit), criterion)| {
        let Some(fit) = fit else { return Ok::<_, IdentifyError>(None) };
        let is_near = *criterion < least + MAY_WIN || *law == ArrivalLaw::Certain;
        let search = ArrivalSearch::new(*law, base, recording).filter(|_| is_near);
        Ok(search.map_or(Some(fit.clone()), |search| search.fit_near(&fit.coordinates)))
    })?;
    let mut rows = Vec::new();
    for (base, fits) in held.iter().zip(found.chunks(laws.len())) {
        let [Some(certain), others @ ..] = fits else { continue };
        for fit in others.iter().flatten() {
            let row = CandidateRow::random(base, fit, certain);
            rows.push(((*base).clone(), fit.clone(), row));
        }
    }
    Ok(rows)
}
