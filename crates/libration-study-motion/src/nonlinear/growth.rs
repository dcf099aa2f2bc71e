//! Growth of the energy drift with the horizon.

use libration::Method;
use libration_report::notation::{count, number};
use libration_report::record::{Cell, Finding, Record, Relation, Series, Table, Tolerance};
use libration_study::{Lab, StudyError};

use super::super::subject::Horizon;
use super::Case;
use crate::nonlinear::NonlinearSettings;

/// A drift beyond this changes the orbit so much that it is another one.
const SMALL: f64 = 0.1;

/// Runs every case over the whole horizon.
pub(super) fn measure(
    lab: &Lab<'_>,
    cases: &[Case<'_>],
    record: &mut Record,
) -> Result<(), StudyError> {
    let (steps, turns) =
        (lab.config.get::<NonlinearSettings>().steps, lab.config.get::<NonlinearSettings>().turns);
    let what = format!("energy drift over {} turns", count(turns));
    let found = lab.sweep(&what, cases, |case| case.subject.horizon(case.method, steps, turns))?;
    let columns = ["system", "integrator", "largest drift", "half-way", "exponent of time"];
    let mut table = Table::new("growth", &columns);
    for (case, horizon) in cases.iter().zip(&found) {
        let grown = Grown::new(horizon, steps);
        // What has left the floats by then has no size.
        if grown.last.is_finite() {
            let what = format!(
                "largest energy drift over {} turns of {} steps",
                count(turns),
                count(steps)
            );
            record.find(Finding::measured(case.id("largest"), case.text(&what), "1", grown.last));
        }
        if let Some(finding) = finding(case, &grown) {
            record.find(finding);
        }
        table.push([
            case.subject.title().into(),
            case.method.title().into(),
            size(grown.last),
            size(grown.half),
            match grown.exponent() {
                exponent if exponent.is_finite() => Cell::rounded(exponent, 2),
                _ => Cell::absent("—"),
            },
        ]);
    }
    record.tables.push(table);
    let per_subject = found.chunks(lab.config.integrators.len().max(1));
    let first_of = cases.iter().step_by(lab.config.integrators.len().max(1));
    for (case, horizons) in first_of.zip(per_subject) {
        record.series.push(series(case, &lab.config.integrators, horizons, steps));
    }
    Ok(())
}

/// A drift as a cell.
fn size(drift: f64) -> Cell {
    if drift.is_finite() { drift.into() } else { Cell::absent("overflows") }
}

/// The running maximum after a turn, half-way, and at the end.
struct Grown {
    turn: f64,
    half: f64,
    last: f64,
    /// The ratio of the horizon's end to what counts as half-way.
    times: f64,
}

impl Grown {
    fn new(horizon: &Horizon, steps: u64) -> Self {
        let at = |step: u64| {
            let i = horizon.step.iter().rposition(|&n| n <= step).unwrap_or(0);
            (horizon.step[i] as f64, horizon.largest[i])
        };
        let end = horizon.step.last().copied().unwrap_or(1);
        let (middle, half) = at(end / 2);
        Grown { turn: at(steps).1, half, last: at(end).1, times: end as f64 / middle }
    }

    /// The exponent of time in the growth from half-way to the end.
    fn exponent(&self) -> f64 {
        (self.last / self.half).ln() / self.times.ln()
    }
}

/// Bounded for a symplectic method, linear for the others as long as the drift is small.
fn finding(case: &Case<'_>, grown: &Grown) -> Option<Finding> {
    let id = case.id("growth");
    let text = case.text("exponent of time in the energy drift, over the second half of the run");
    let exponent = grown.exponent();
    if !exponent.is_finite() {
        return None;
    }
    // Theory is about motion in a bounded part of space.
    if case.law.velocity_dependent || !case.is_bounded {
        return Some(Finding::measured(id, text, "1", exponent));
    }
    if case.is_symplectic() {
        let why = "a drift that grows linearly has 1, one that walks at random ½; an orbit that \
                   still visits rarer phases for the first time has less than half of that";
        let bound = Tolerance::absolute(0.2, why);
        // A drift as large as the energy itself is no perturbation, and nothing is promised of it.
        return Some(match grown.turn < SMALL {
            true => Finding::related(id, text, "1", Relation::AtMost, 0.0, exponent, bound),
            false => Finding::measured(id, text, "1", exponent),
        });
    }
    // The swing within a turn adds to the ramp, and the ramp steepens as the orbit changes.
    let swing = grown.turn / grown.half;
    let uncertainty = 2.0 * swing + 4.0 * grown.last;
    Some(if case.closes && uncertainty < 0.2 {
        let why = format!(
            "twice the share {} of the first turn’s swing in the drift half-way, and four times \
             the drift itself, by which the rate may change",
            number(swing, 2)
        );
        Finding::predicted(id, text, "1", 1.0, exponent, Tolerance::absolute(uncertainty, why))
    } else {
        Finding::measured(id, text, "1", exponent)
    })
}

/// The running maxima of all methods on one system.
fn series(case: &Case<'_>, methods: &[Method], horizons: &[Horizon], steps: u64) -> Series {
    let step = horizons.first().map(|h| h.step.clone()).unwrap_or_default();
    let turns = step.iter().map(|&n| n as f64 / steps as f64).collect();
    let series = Series::new(format!("growth-{}", case.subject.name())).with("turns", "1", turns);
    methods
        .iter()
        .zip(horizons)
        .fold(series, |series, (m, horizon)| series.with(m.name(), "1", horizon.largest.clone()))
}
