//! The choice of a model.

use crate::arrival_selection::with_arrivals;
use crate::arrivals::ArrivalFit;
use crate::candidate::CandidateRow;
use crate::dependence::Dependence;
use crate::estimate::Estimate;
use crate::hold::Hold;
use crate::model::Model;
use crate::noise::NoiseKind;
use crate::request::IdentifyError;
use crate::residuals::ResidualTests;
use crate::start::Start;
use crate::task::Task;

/// The chosen model, and what was tried.
pub(crate) struct Selection<'w> {
    /// The best fit in which all commands arrive; with random arrivals, the one that they were searched from.
    pub(crate) estimate: Estimate<'w>,
    /// Random arrivals, if they are better.
    pub(crate) arrivals: Option<ArrivalFit>,
    /// All models, the best first.
    pub(crate) candidates: Vec<CandidateRow>,
    /// The best fit of a lag of first order with white noise.
    pub(crate) lag: Option<Estimate<'w>>,
    /// Whether the response depends on the command.
    pub(crate) dependence: Dependence,
    /// Models that were not examined.
    pub(crate) not_examined: Vec<String>,
}

/// Forms of response whose noise and arrivals are searched.
const PURSUED: usize = 3;

/// Forms of response with held commands whose arrivals are searched.
const HELD: usize = 2;

/// Fewest changes of a command of which some may be lost or late: of fewer, a law of arrivals is a guess.
const FEWEST_CHANGES: usize = 20;

/// Fits in which all commands arrive.
struct Fits<'w> {
    /// Forms of response with their first noise, the best first.
    searched: Vec<Estimate<'w>>,
    /// Those with lines between commands, which are not chosen.
    lines: Vec<Estimate<'w>>,
    /// Forms with each noise, the best first.
    all: Vec<Estimate<'w>>,
    not_examined: Vec<String>,
}

/// The model with the least criterion of Bayes: forms of response with white noise first, then noise and arrivals of the best of them.
pub(crate) fn select<'w>(task: Task<'_, 'w>, start: Start) -> Result<Selection<'w>, IdentifyError> {
    let Task { recording, request, work, .. } = task;
    let mut found = fits(task, start)?;
    if start == Start::Rest && request.start.is_none() && !begins_at_rest(&found, task)? {
        found = fits(task, Start::Held)?;
    }
    let Fits { searched, lines, all: fits, mut not_examined } = found;
    let lag = searched.iter().find(|fit| fit.model.response.name() == "lag").cloned();
    let Some(best) = fits.first() else {
        work.check()?;
        return Err(match not_examined.is_empty() {
            true => IdentifyError::NoFit,
            false => IdentifyError::Budget(task.evaluations),
        });
    };
    let dependence = Dependence::of(&fits, recording);
    work.check()?;
    let is_suspect =
        best.model.noise != NoiseKind::White || ResidualTests::of(best, recording).are_suspect();
    let changes = recording.commands.windows(2).filter(|pair| pair[0] != pair[1]).count();
    let mut random = Vec::new();
    // A command that is missing from the log looks like one that is lost.
    let is_wanted = request.arrivals
        && is_suspect
        && dependence == Dependence::Shown
        && recording.missing_commands() == 0;
    if is_wanted && changes >= FEWEST_CHANGES {
        let held = searched.iter().filter(|fit| fit.model.hold == Hold::Zero).take(HELD);
        random = with_arrivals(held.collect(), task, &mut not_examined)?;
    } else if is_wanted {
        not_examined.push(format!(
            "lost and late commands ({changes} changes of the command, at least {FEWEST_CHANGES} needed)"
        ));
    }
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
    let estimate = estimate.with_effort(task.effort());
    Ok(Selection { estimate, arrivals, candidates, lag, dependence, not_examined })
}

/// Fits of each form of response with each noise.
fn fits<'w>(task: Task<'_, 'w>, start: Start) -> Result<Fits<'w>, IdentifyError> {
    let Task { recording, request, work, .. } = task;
    let models: Vec<Model<'w>> = request
        .responses
        .iter()
        .flat_map(|response| request.holds.iter().map(|&hold| (response.clone(), hold)))
        .map(|(response, hold)| task.model(response, hold, start))
        .collect();
    let results = work.sweep("responses", &models, |model| {
        Ok::<_, IdentifyError>(task.fit(model, |model| Estimate::search(model, recording)))
    })?;
    let mut not_examined = Vec::new();
    let mut searched = examined(results, &mut not_examined);
    by_criterion(&mut searched);
    // Receivers hold commands. Lines between them, half a period earlier, imitate a held command so well that any defect of a log makes
    // them the better model: they are chosen only on request.
    let is_asked =
        |fit: &&Estimate<'_>| !request.holds.contains(&Hold::Zero) || fit.model.hold == Hold::Zero;
    let lines = searched.iter().filter(|fit| !is_asked(fit)).cloned().collect();
    searched.retain(|fit| is_asked(&fit));
    let all = with_noises(&searched, task, &mut not_examined)?;
    work.check()?;
    Ok(Fits { searched, lines, all, not_examined })
}

/// The fits of searches that ended; the names of the others are appended.
fn examined<'w>(
    results: Vec<Result<Option<Estimate<'w>>, String>>,
    not_examined: &mut Vec<String>,
) -> Vec<Estimate<'w>> {
    let (found, missing): (Vec<_>, Vec<_>) = results.into_iter().partition(Result::is_ok);
    not_examined.extend(missing.into_iter().filter_map(Result::err));
    found.into_iter().filter_map(Result::ok).flatten().collect()
}

/// Whether no fit with free initial states is better than the best at rest.
fn begins_at_rest(found: &Fits<'_>, task: Task<'_, '_>) -> Result<bool, IdentifyError> {
    let Some(best) = found.all.first() else { return Ok(true) };
    let bases: Vec<&Estimate<'_>> = found.searched.iter().filter(|fit| fit.has_states()).collect();
    let criteria = task.work.sweep("start", &bases, |base| {
        let model = Model { start: Start::Held, ..base.model.with_effort(task.effort()) };
        let step = 0.2 * model.interval;
        let free = Estimate::from_start(&model, task.recording, &base.coordinates, step);
        Ok::<_, IdentifyError>(free.map_or(f64::INFINITY, |free| free.criterion()))
    })?;
    Ok(criteria.into_iter().all(|criterion| criterion >= best.criterion()))
}

fn by_criterion(fits: &mut [Estimate<'_>]) {
    fits.sort_by(|a, b| a.criterion().total_cmp(&b.criterion()));
}

/// The fits with each kind of noise, the best first; of the best forms of response only, except with white noise.
fn with_noises<'w>(
    searched: &[Estimate<'w>],
    task: Task<'_, 'w>,
    not_examined: &mut Vec<String>,
) -> Result<Vec<Estimate<'w>>, IdentifyError> {
    let Task { recording, request, work, .. } = task;
    let others = request.noises.iter().filter(|&&noise| noise != NoiseKind::White);
    let jobs: Vec<(&Estimate<'w>, NoiseKind)> = others
        .flat_map(|&noise| searched.iter().take(PURSUED).map(move |fit| (fit, noise)))
        // A disturbance of a plant without states is an error of the measurement.
        .filter(|(fit, noise)| *noise != NoiseKind::Disturbance || fit.has_states())
        .filter(|(fit, _)| fit.model.noise == NoiseKind::White)
        .collect();
    let results = work.sweep("noise", &jobs, |&(fit, noise)| {
        let model = Model { noise, ..fit.model.with_effort(task.effort()) };
        Ok::<_, IdentifyError>(task.fit(&model, |model| fit.extended(model, recording)))
    })?;
    let mut fits = examined(results, not_examined);
    if request.noises.contains(&NoiseKind::White) || fits.is_empty() {
        fits.extend(searched.iter().cloned());
    }
    by_criterion(&mut fits);
    Ok(fits)
}
