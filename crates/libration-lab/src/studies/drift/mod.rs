//! Energy drift over long horizons, beside what theory says it must be.

mod claims;
mod crossover;
mod overflow;
mod portrait;
mod render;
mod repeat;
mod setting;
mod trial;
mod watch;

use libration::Method;

use self::setting::{ROUNDING, Setting};
use self::trial::Trial;
use crate::notation::{count, number, seconds};
use crate::page::Page;
use crate::record::{Finding, RecordError, Relation, Series, Table, Tolerance};
use crate::study::{Study, StudyError};
use crate::{Lab, Record};

/// The study `drift`.
#[derive(Clone, Copy, Debug)]
pub struct Drift;

impl Study for Drift {
    fn name(&self) -> &'static str {
        "drift"
    }

    fn question(&self) -> &'static str {
        "Does the energy stay near its start, and does each method do what theory says it must?"
    }

    fn run(&self, lab: &Lab<'_>) -> Result<Record, StudyError> {
        let mut record = Record::new(self.name(), self.question());
        trials(lab, &mut record)?;
        repeat::compare(lab, &mut record)?;
        crossover::measure(lab, &mut record)?;
        portrait::trace(lab, &mut record)?;
        claims::judge(lab.config, &mut record);
        Ok(record)
    }

    fn render(&self, record: &Record, page: &mut Page) -> Result<(), RecordError> {
        render::render(record, page)
    }
}

/// A time step in identifiers and names of series, as in `dt-0.001`.
fn tag(dt: f64) -> String {
    format!("dt-{dt}")
}

/// Every method at every time step, from the configured and from the worst start.
fn trials(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let config = lab.config;
    let settings: Vec<Setting> = config
        .drift
        .dt
        .iter()
        .flat_map(|&dt| config.integrators.iter().map(move |&m| Setting::new(config, m, dt)))
        .collect();
    let what = format!("energy drift over {} steps", count(config.drift.steps));
    let found = lab.sweep(&what, &settings, Trial::run)?;
    let columns = ["Δt (s)", "integrator", "predicted", "measured", "difference", "worst start"];
    let mut table = Table::new("largest drift", &columns);
    for trial in &found {
        record.find(largest(trial));
        record.find(within_band(trial));
        if let Some(worst) = worst(trial) {
            record.find(worst);
        }
        table.push([
            trial.setting.dt.into(),
            trial.setting.method.title().into(),
            trial.shown(trial.predicted_log10).into(),
            trial.shown(trial.measured_log10).into(),
            trial.difference().into(),
            trial.worst.map_or_else(|| "any".into(), |w| number(w.measured, 5).into()),
        ]);
    }
    record.tables.push(table);
    let chunks = found.chunks(config.integrators.len().max(1));
    for (&dt, trials) in config.drift.dt.iter().zip(chunks) {
        record.series.push(series(dt, trials));
        record.series.extend(trials.iter().map(Trial::signed_series));
    }
    Ok(())
}

/// The largest drift; where no float holds it, its logarithm.
fn largest(trial: &Trial) -> Finding {
    let Setting { method, dt, steps, .. } = trial.setting;
    let id = format!("drift.{}.{}.largest", method.name(), tag(dt));
    let text = format!(
        "{} at Δt = {}: largest relative energy drift over {} steps",
        method.title(),
        seconds(dt, 3),
        count(steps)
    );
    let tolerance = trial.setting.rounding();
    match trial.overflow {
        // What no float can hold is compared by the step at which it leaves their range.
        Some(overflow) => Finding::predicted(
            id.replace(".largest", ".overflow"),
            format!(
                "{} at Δt = {}: step at which the energy leaves the range of f64",
                method.title(),
                seconds(dt, 3)
            ),
            "steps",
            overflow.predicted as f64,
            overflow.measured as f64,
            Tolerance::absolute(1.0, "rounding may move the crossing of a limit by a step"),
        ),
        None => Finding::predicted(
            id,
            text,
            "1",
            trial.predicted(),
            trial.measured(),
            Tolerance::absolute(tolerance * (1.0 + trial.predicted()), ROUNDING),
        ),
    }
}

/// The whole run lies within the closed-form envelope.
fn within_band(trial: &Trial) -> Finding {
    let Setting { method, dt, .. } = trial.setting;
    Finding::related(
        format!("drift.{}.{}.envelope", method.name(), tag(dt)),
        format!(
            "{} at Δt = {}: largest excursion beyond the closed-form envelope, relative to 1 + |δE|",
            method.title(),
            seconds(dt, 3)
        ),
        "1",
        Relation::AtMost,
        0.0,
        trial.excursion,
        Tolerance::absolute(trial.setting.rounding(), ROUNDING),
    )
}

/// The largest drift from the start that drifts most, if starts differ.
fn worst(trial: &Trial) -> Option<Finding> {
    let Setting { method, dt, .. } = trial.setting;
    let worst = trial.worst?;
    Some(Finding::predicted(
        format!("drift.{}.{}.worst", method.name(), tag(dt)),
        format!(
            "{} at Δt = {}: largest drift from the worst start, ({}, {})",
            method.title(),
            seconds(dt, 3),
            number(worst.start.q[0], 3),
            number(worst.start.v[0], 3)
        ),
        "1",
        worst.predicted,
        worst.measured,
        Tolerance::absolute(trial.setting.rounding() * (1.0 + worst.predicted), ROUNDING),
    ))
}

/// The running maxima of all methods at one time step.
fn series(dt: f64, trials: &[Trial]) -> Series {
    let steps = trials.first().map(|t| t.sampled_steps()).unwrap_or_default();
    let times = steps.iter().map(|&n| n * dt).collect();
    let mut series = Series::new(tag(dt)).with("step", "1", steps).with("t", "s", times);
    for trial in trials {
        let name = trial.setting.method.name();
        series = series.with(format!("{name} measured"), "1", trial.running.clone()).with(
            format!("{name} predicted"),
            "1",
            trial.predicted_running.clone(),
        );
    }
    series
}

/// The methods of which a record holds drifts, in the order of the catalogue.
fn methods(record: &Record) -> Vec<Method> {
    let studied = |m: &Method| {
        let prefix = format!("drift.{}.", m.name());
        record.findings.iter().any(|f| f.id.starts_with(&prefix))
    };
    Method::ALL.into_iter().filter(studied).collect()
}
