//! Stability limits, and orbits at a large step.

use libration::Method;
use libration_report::notation::{count, seconds};
use libration_report::record::{Cell, Finding, Record, Series, Table, Tolerance};
use libration_study::{Lab, StudyError};

use super::super::subject::{Orbits, Portrait, StabilityLimit};
use super::Case;
use crate::stable_step::largest_stable;

/// Steps of an orbit about the equilibrium.
const SMALL_STEPS: u64 = 20_000;

/// Points of a portrait.
const POINTS: u64 = 280;

/// Searches the limits of every case.
pub(super) fn search(
    lab: &Lab<'_>,
    cases: &[Case<'_>],
    record: &mut Record,
) -> Result<(), StudyError> {
    let steps = lab.effort.choose(400, 1_000, 10_000);
    let execution = lab.alone()?;
    let found = lab.sweep("largest stable steps", cases, |case| {
        let linear = largest_stable(case.method)?;
        let subject = case.subject;
        let small = match subject.frequency() {
            Some(omega) => {
                let loss =
                    subject.stability_limit(&execution, Orbits::Small, case.method, SMALL_STEPS);
                Some((linear / omega, omega, loss))
            }
            None => None,
        };
        // A method that is never stable loses every orbit, the later the smaller the step.
        let large = match linear > 0.0 {
            true => subject.stability_limit(&execution, Orbits::Configured, case.method, steps),
            false => None,
        };
        Ok((small, large))
    })?;
    let columns =
        ["system", "integrator", "small: predicted (s)", "measured (s)", "from the start (s)"];
    let mut table = Table::new("limits", &columns);
    for (case, (small, large)) in cases.iter().zip(&found) {
        let mut cells = [const { None }; 3];
        if let Some((predicted, omega, Some(StabilityLimit { dt: measured, .. }))) = *small {
            record.find(small_orbit(case, predicted, omega, measured));
            cells[0] = Some(Cell::rounded(predicted, 6));
            cells[1] = Some(Cell::rounded(measured, 6));
        }
        if let Some(StabilityLimit { dt: measured, spacing }) = *large {
            let what = format!(
                "first Δt at which the energy changes by as much as there was, from the configured \
                 start within {} steps, among steps that are {} apart: a gap between two of them \
                 would not be seen",
                count(4 * steps),
                seconds(spacing, 2)
            );
            record.find(Finding::measured(case.id("start-limit"), case.text(&what), "s", measured));
            cells[2] = Some(measured.into());
        }
        table.push(
            [case.subject.title().into(), case.method.title().into()]
                .into_iter()
                .chain(cells.map(|cell| cell.unwrap_or_else(|| Cell::absent("—")))),
        );
    }
    record.tables.push(table);
    let larges: Vec<Option<f64>> = found.iter().map(|(_, l)| l.map(|loss| loss.dt)).collect();
    portraits(lab, cases, &larges, record)
}

/// The limit about the equilibrium: that of the oscillator, at the frequency of its linearisation.
fn small_orbit(case: &Case<'_>, predicted: f64, omega: f64, measured: f64) -> Finding {
    let n = SMALL_STEPS as f64;
    let (size, why) = match predicted {
        0.0 => (0.05 / omega, "the smallest step that is tried, ωΔt = 0.05".to_owned()),
        limit => (
            limit * 10.0 / n,
            format!(
                "beyond the limit an orbit grows by at least the relative excess of the step a \
                 step: a thousandfold within {} steps at an excess of 7/n, and below it an orbit \
                 that beats may look lost from (1/1000)² on",
                count(SMALL_STEPS)
            ),
        ),
    };
    Finding::predicted(
        case.id("small-limit"),
        case.text("largest Δt at which a small orbit about the equilibrium stays small"),
        "s",
        predicted,
        measured,
        Tolerance::absolute(size, why),
    )
}

/// Orbits at a step that is large for velocity Verlet.
fn portraits(
    lab: &Lab<'_>,
    cases: &[Case<'_>],
    limits: &[Option<f64>],
    record: &mut Record,
) -> Result<(), StudyError> {
    let step = |case: &Case<'_>| {
        let same = |t: &Case<'_>| t.subject.name() == case.subject.name();
        let verlet =
            cases.iter().zip(limits).find(|(t, _)| same(t) && t.method == Method::VelocityVerlet);
        let limit = verlet.and_then(|(_, limit)| *limit).filter(|&limit| limit > 0.0);
        limit.map_or(case.subject.turn() / 16.0, |limit| 0.5 * limit)
    };
    let found = lab
        .sweep("portraits", cases, |case| case.subject.portrait(case.method, step(case), POINTS))?;
    for (case, portrait) in cases.iter().zip(found) {
        let n = portrait.x.len();
        let named = |series: Series, Portrait { x, y, axes: [abscissa, ordinate], units }| {
            series.with(abscissa, &units[0], x).with(ordinate, &units[1], y)
        };
        let name = format!("portrait-{}-{}", case.subject.name(), case.method.name());
        record.series.push(named(Series::new(name), portrait).with("dt", "s", vec![step(case); n]));
        let path = format!("path-{}", case.subject.name());
        if record.series(&path).is_err() {
            // RK4 at 400 steps a turn is the orbit itself, to the width of a line.
            let dt = case.subject.turn() / 400.0;
            let exact = case.subject.portrait(Method::Rk4, dt, 2 * POINTS)?;
            record.series.push(named(Series::new(path), exact));
        }
    }
    Ok(())
}
