//! The study `drift`: energy drift over long horizons, predicted and measured.

mod actions;
mod claims;
mod crossover;
mod drift_observer;
mod drift_run;
mod invariant;
mod overflow;
mod portrait;
mod render;
mod repeatability;
mod setting;
mod settings;
mod source_claims;
mod source_setting;

use libration_study::SourceClaim;

pub use self::settings::DriftSettings;
use self::source_claims::SOURCE_CLAIMS;
use libration::Method;
use libration_report::Record;
use libration_report::notation::{count, number, seconds};
use libration_report::page::Page;
use libration_report::record::{Cell, Finding, RecordError, Relation, Series, Table, Tolerance};
use libration_study::{Lab, Section, Study, StudyError};

use self::drift_run::DriftRun;
use self::setting::{ROUNDING, Setting, UNCERTAINTY};

/// The study `drift`.
#[derive(Clone, Copy, Debug)]
pub struct Drift;

impl Study for Drift {
    fn name(&self) -> &'static str {
        "drift"
    }

    fn question(&self) -> &'static str {
        "Does the energy stay near its initial value, and does its drift agree with theory?"
    }

    fn source_claims(&self) -> &'static [SourceClaim] {
        SOURCE_CLAIMS
    }

    fn settings(&self) -> Option<Section> {
        Some(Section::of::<DriftSettings>())
    }

    fn run(&self, lab: &Lab<'_>) -> Result<Record, StudyError> {
        let mut record = Record::new(self.name(), self.question());
        trials(lab, &mut record)?;
        repeatability::compare(lab, &mut record)?;
        crossover::measure(lab, &mut record)?;
        portrait::trace(lab, &mut record)?;
        claims::judge(lab.config, &mut record);
        Ok(record)
    }

    fn render(&self, record: &Record, page: &mut Page) -> Result<(), RecordError> {
        render::render(record, page)
    }
}

/// Rounding error of the energy above which there is no prediction.
const LOST: f64 = 0.5;

/// A time step in identifiers and names of series and files, as in `dt-0.001` or `dt-1e-300`.
fn tag(dt: f64) -> String {
    let plain = format!("dt-{dt}");
    if plain.len() > 24 { format!("dt-{dt:e}") } else { plain }
}

/// Every method at every time step, from the configured and from the worst start.
fn trials(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let config = lab.config;
    let settings: Vec<Setting> = config
        .get::<DriftSettings>()
        .dt
        .iter()
        .flat_map(|&dt| config.integrators.iter().map(move |&m| Setting::new(config, m, dt)))
        .collect();
    let what = format!("energy drift over {} steps", count(config.get::<DriftSettings>().steps));
    let found = lab.sweep(&what, &settings, DriftRun::run)?;
    let columns = [
        "Δt (s)",
        "integrator",
        "predicted",
        "log₁₀ predicted",
        "measured",
        "difference",
        "worst start",
    ];
    let mut table = Table::new("largest drift", &columns);
    for trial in &found {
        record.find(largest(trial));
        let others = [within_band(trial), conserved(trial), worst(trial)];
        others.into_iter().flatten().for_each(|finding| record.find(finding));
        table.push([
            trial.setting.dt.into(),
            trial.setting.method.title().into(),
            trial.predicted_cell(),
            Cell::rounded(trial.predicted_log10, 6),
            trial.measured_cell(),
            trial.difference(),
            trial.worst.map_or_else(|| Cell::absent("any"), |w| Cell::rounded(w.measured, 5)),
        ]);
    }
    record.tables.push(table);
    let chunks = found.chunks(config.integrators.len().max(1));
    for (&dt, trials) in config.get::<DriftSettings>().dt.iter().zip(chunks) {
        record.series.push(series(dt, trials));
        record.series.extend(trials.iter().map(DriftRun::signed_series));
    }
    Ok(())
}

/// The largest drift; where no float holds it, its logarithm.
fn largest(trial: &DriftRun) -> Finding {
    let Setting { method, dt, steps, .. } = trial.setting;
    let id = format!("drift.{}.{}.largest", method.name(), tag(dt));
    let text = format!(
        "{} at Δt = {}: largest relative energy drift over {} steps",
        method.title(),
        seconds(dt, 3),
        count(steps)
    );
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
            Tolerance::absolute(
                overflow.uncertainty(&trial.setting),
                "rounding may move the crossing of a limit by a step, and as many as the energy \
                 takes to grow by what rounding leaves",
            ),
        ),
        None => unless_lost(trial, id, text, trial.predicted(), trial.measured(), trial.band),
    }
}

/// A largest drift beside its prediction; without one where rounding may leave as much as the orbit.
fn unless_lost(
    trial: &DriftRun,
    id: String,
    text: String,
    predicted: f64,
    measured: f64,
    band: Option<(f64, f64)>,
) -> Finding {
    let uncertainty = trial.setting.uncertainty(predicted, band);
    if uncertainty < LOST * (1.0 + predicted) {
        let tolerance = Tolerance::absolute(uncertainty, UNCERTAINTY);
        Finding::predicted(id, text, "1", predicted, measured, tolerance)
    } else {
        Finding::measured(id, text, "1", measured)
    }
}

/// The whole run lies within the closed-form envelope, where there is one.
fn within_band(trial: &DriftRun) -> Option<Finding> {
    let Setting { method, dt, .. } = trial.setting;
    let excursion = trial.excursion?;
    let rounding = Some(trial.setting.rounding()).filter(|&rounding| rounding < LOST)?;
    Some(Finding::related(
        format!("drift.{}.{}.envelope", method.name(), tag(dt)),
        format!(
            "{} at Δt = {}: largest excursion beyond the closed-form envelope, relative to 1 + |δE|",
            method.title(),
            seconds(dt, 3)
        ),
        "1",
        Relation::AtMost,
        0.0,
        excursion,
        Tolerance::absolute(rounding, ROUNDING),
    ))
}

/// What a symplectic step conserves stays what it is: this tells rounding, which may grow with the
/// run, from the error of the method, which does not.
fn conserved(trial: &DriftRun) -> Option<Finding> {
    let Setting { method, dt, steps, .. } = trial.setting;
    let strayed = trial.invariant?;
    let rounding = Some(trial.setting.rounding()).filter(|&rounding| rounding < LOST)?;
    Some(Finding::predicted(
        format!("drift.{}.{}.invariant", method.name(), tag(dt)),
        format!(
            "{} at Δt = {}: largest relative change over {} steps of the quadratic form that its \
             step conserves",
            method.title(),
            seconds(dt, 3),
            count(steps)
        ),
        "1",
        0.0,
        strayed,
        Tolerance::absolute(rounding, ROUNDING),
    ))
}

/// The largest drift from the start that drifts most, if starts differ.
fn worst(trial: &DriftRun) -> Option<Finding> {
    let Setting { method, dt, .. } = trial.setting;
    let worst = trial.worst?;
    Some(unless_lost(
        trial,
        format!("drift.{}.{}.worst", method.name(), tag(dt)),
        format!(
            "{} at Δt = {}: largest drift from the worst start, ({}, {})",
            method.title(),
            seconds(dt, 3),
            number(worst.start.q[0], 3),
            number(worst.start.v[0], 3)
        ),
        worst.predicted,
        worst.measured,
        worst.band,
    ))
}

/// The running maxima of all methods at one time step.
fn series(dt: f64, trials: &[DriftRun]) -> Series {
    let steps = trials.first().map(|t| t.log_spaced_steps()).unwrap_or_default();
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
