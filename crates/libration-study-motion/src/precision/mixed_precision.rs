//! Separate float types for the state, the force and the clock.

use std::f64::consts::TAU;

use libration::analysis::float_clock;
use libration::integrator::VelocityVerlet;
use libration::number::TwoFloat;
use libration::system::MixedPrecision;
use libration::{Float, Integrator, Model, State};
use libration_report::Record;
use libration_report::notation::count;
use libration_report::record::{Cell, Finding, Table, Tolerance};
use libration_study::{Lab, StudyError};

use super::in_float::InFloat;
use super::orbits::follow;
use super::types::ERRORS;
use crate::precision::PrecisionSettings;

/// The precision of a state and a force, and how they are tried.
type Part = (&'static str, &'static str, fn(&Lab<'_>) -> Option<Found>);

const PARTS: [Part; 4] = [
    ("f64", "f64", of::<f64, f64, TwoFloat>),
    ("f64", "f32", of::<f64, f32, TwoFloat>),
    ("f32", "f64", of::<f32, f64, f64>),
    ("f32", "f32", of::<f32, f32, f64>),
];

/// Predicted and measured result of a float type for the state and one for the force.
struct Found {
    /// Scatter of the energy over the orbits after all steps.
    scatter: [f64; 2],
    orbits: usize,
    /// Phase in rad after all steps, beyond that of exact arithmetic with the same time step.
    phase: [f64; 2],
    phase_error: f64,
    /// Angle of a step in exact arithmetic.
    angle: f64,
    dt: f64,
}

/// All combinations at the largest time step.
pub(super) fn measure(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let steps = lab.config.get::<PrecisionSettings>().steps;
    let found = lab.sweep("state, force and clock", &PARTS, |(_, _, run)| Ok(run(lab)))?;
    let columns = [
        "state",
        "force",
        "clock",
        "energy, predicted",
        "energy, measured",
        "phase, predicted (rad)",
        "phase, measured (rad)",
    ];
    let mut table = Table::new("parts", &columns);
    for ((state, force, _), found) in PARTS.iter().zip(&found) {
        let Some(found) = found else { continue };
        let name = format!("precision.state-{state}.force-{force}");
        let what = format!("state in {state}, force in {force}, after {} steps", count(steps));
        let [walk, scatter] = found.scatter;
        let relative = ERRORS / (2.0 * (found.orbits as f64 - 1.0)).sqrt();
        record.find(Finding::predicted(
            format!("{name}.scatter"),
            format!("{what}: scatter of the energy over {} orbits", found.orbits),
            "1",
            walk,
            scatter,
            Tolerance::relative(
                relative + 0.1,
                "four standard errors of the scatter of m orbits, and a tenth for what roundings \
                 have in common",
            ),
        ));
        record.find(Finding::predicted(
            format!("{name}.phase"),
            format!("{what}: phase beyond that of exact arithmetic, by the rounded parameters"),
            "rad",
            found.phase[0],
            found.phase[1],
            Tolerance::absolute(
                found.phase_error,
                "what roundings across the orbit leave, four times over; a tenth of z·u a step for those \
                 that are alike; and four roundings of the whole angle",
            ),
        ));
        for (clock, behind) in [("counted", 0.0), ("f32 sum", late(found.dt, steps))] {
            // A time that is shown too small is an angle that seems too large.
            let [predicted, measured] = found.phase.map(|phase| phase + behind * found.angle);
            table.push([
                (*state).into(),
                (*force).into(),
                clock.into(),
                walk.into(),
                scatter.into(),
                Cell::rounded(predicted, 3),
                Cell::rounded(measured, 3),
            ]);
        }
    }
    record.tables.push(table);
    Ok(())
}

/// Steps by which a clock in `f32` is behind.
fn late(dt: f64, steps: u64) -> f64 {
    float_clock(dt as f32, steps).map_or(f64::NAN, |t| steps as f64 - f64::from(t) / dt)
}

fn of<S: Float, G: Float, W: Float>(lab: &Lab<'_>) -> Option<Found> {
    let (config, steps) = (lab.config, lab.config.get::<PrecisionSettings>().steps);
    let &dt = config.get::<PrecisionSettings>().dt.last()?;
    let one = InFloat::<_, S>::with_force_in::<G>(VelocityVerlet, config, dt)?;
    let exact = InFloat::<_, f64>::new(VelocityVerlet, config, dt)?;
    let coarser = S::UNIT_ROUNDOFF.max(G::UNIT_ROUNDOFF);
    if !one.rounds_at_random(coarser) {
        return None;
    }
    let force = MixedPrecision::<_, G>::new(Model::<1>::on::<G>(&one.model));
    let step = |state| VelocityVerlet.step(&force, state, one.dt);
    let (wide, wide_dt) = (Model::<1>::on::<W>(&one.model), W::from_f64(one.dt.to_f64()));
    let unrounded = |state| VelocityVerlet.step(&wide, state, wide_dt);
    let local = one.rounding_of(lab.effort.choose(100_000, 200_000, 1_000_000), step, unrounded)?;
    let orbits = lab.effort.choose(16, 24, 128);
    let change = |from: &State<S, 1>, to: &State<S, 1>| one.change(from, to);
    let followed = follow(&one.starts(orbits), &[steps], step, change);
    let drifts: Vec<f64> = followed.iter().map(|orbit| orbit.seen[0]).collect();
    let mean = drifts.iter().sum::<f64>() / orbits as f64;
    let squares = drifts.iter().map(|drift| (drift - mean).powi(2)).sum::<f64>();
    let n = steps as f64;
    let walk = (local.spread * n).sqrt();
    let end = (0..steps).fold(one.start, |state, _| step(state));
    let slip = n * (one.angle - exact.angle);
    let turned = between(one.normal(&one.start), one.normal(&end)) - n * exact.angle;
    // The angle of all steps is rounded, too.
    let angle = 4.0 * f64::UNIT_ROUNDOFF * n * exact.angle;
    Some(Found {
        scatter: [walk, (squares / (orbits as f64 - 1.0)).sqrt()],
        orbits,
        phase: [slip, nearest_turn(turned, slip)],
        phase_error: ERRORS * walk + 0.1 * one.z() * coarser * n + angle,
        angle: exact.angle,
        dt,
    })
}

/// The angle from one point to another, clockwise, in rad.
pub(super) fn between((x, y): (f64, f64), (to_x, to_y): (f64, f64)) -> f64 {
    f64::atan2(y * to_x - x * to_y, x * to_x + y * to_y)
}

/// `angle`, which is known up to whole turns, near `guess`.
pub(super) fn nearest_turn(angle: f64, guess: f64) -> f64 {
    angle - TAU * ((angle - guess) / TAU).round()
}
