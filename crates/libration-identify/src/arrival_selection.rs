//! The choice among laws of arrivals.

use crate::arrivals::{ArrivalFit, ArrivalLaw, ArrivalSearch};
use crate::candidate::CandidateRow;
use crate::estimate::Estimate;
use crate::request::IdentifyError;
use crate::task::Task;

/// Models whose criterion is larger by more than this before they are fitted to all responses are not fitted to them.
const MAY_WIN: f64 = 60.0;

/// Jitter, losses and two delays, with white noise; the names of those whose search did not end are appended.
pub(crate) fn with_arrivals<'w>(
    held: Vec<&Estimate<'w>>,
    task: Task<'_, 'w>,
    not_examined: &mut Vec<String>,
) -> Result<Vec<(Estimate<'w>, ArrivalFit, CandidateRow)>, IdentifyError> {
    let Task { recording, work, evaluations, .. } = task;
    let laws = ArrivalLaw::ALL;
    // Each law has an effort of its own.
    let bases: Vec<(Estimate<'w>, ArrivalLaw)> = held
        .iter()
        .flat_map(|base| laws.map(|law| (base.with_effort(task.effort()), law)))
        .collect();
    let rough = work.sweep("arrivals", &bases, |(base, law)| {
        let search = ArrivalSearch::new(*law, base, recording);
        Ok::<_, IdentifyError>(search.and_then(|search| search.rough()))
    })?;
    // Only what may win is fitted to all responses.
    let count = |base: &Estimate<'_>| base.regression.residuals.len();
    let criteria: Vec<f64> = bases
        .iter()
        .zip(&rough)
        .map(|((base, _), fit)| {
            fit.as_ref().map_or(f64::INFINITY, |fit| fit.criterion(count(base)))
        })
        .collect();
    let least = criteria.iter().copied().fold(f64::INFINITY, f64::min);
    let jobs: Vec<_> = bases.iter().zip(rough).zip(criteria).collect();
    let found = work.sweep("arrivals", &jobs, |(((base, law), fit), criterion)| {
        let Some(fit) = fit else { return Ok::<_, IdentifyError>(None) };
        let is_near = *criterion < least + MAY_WIN || *law == ArrivalLaw::Certain;
        let search = ArrivalSearch::new(*law, base, recording).filter(|_| is_near);
        Ok(search.map_or(Some(fit.clone()), |search| search.fit_near(&fit.coordinates)))
    })?;
    work.check()?;
    let mut rows = Vec::new();
    for (bases, fits) in bases.chunks(laws.len()).zip(found.chunks(laws.len())) {
        let is_ended = |base: &Estimate<'_>| !base.model.effort.is_exhausted();
        for (base, law) in bases.iter().filter(|(base, _)| !is_ended(base)) {
            not_examined.push(format!(
                "{} arrivals of a {} response (budget of {evaluations} evaluations)",
                law.name(),
                base.model.response.name()
            ));
        }
        // Without certain arrivals in the same filter there is nothing to compare with.
        let [Some(certain), others @ ..] = fits else { continue };
        if !is_ended(&bases[0].0) {
            continue;
        }
        for ((base, _), fit) in
            bases[1..].iter().zip(others).filter(|((base, _), _)| is_ended(base))
        {
            let Some(fit) = fit else { continue };
            rows.push((base.clone(), fit.clone(), CandidateRow::random(base, fit, certain)));
        }
    }
    Ok(rows)
}
