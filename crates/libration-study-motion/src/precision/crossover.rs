//! The number of steps after which rounding exceeds the error of the method.

use libration::integrator::VelocityVerlet;
use libration::{Float, State};
use libration_report::Record;
use libration_report::notation::{count, seconds};
use libration_report::record::{Cell, Finding, Table, Tolerance};
use libration_study::{Lab, StudyError, log_spaced_steps};

use super::in_float::InFloat;
use super::orbits::follow;
use super::tag;
use super::types::ERRORS;
use crate::precision::PrecisionSettings;

/// Samples of the drift for each decade of steps, and orbits that are followed.
const PER_DECADE: f64 = 32.0;
const ORBITS: usize = 256;

/// Predicts where rounding overtakes truncation in `f32`, and finds it where it is within reach.
pub(super) fn measure(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let config = &lab.config.get::<PrecisionSettings>();
    let found = lab.sweep("rounding and truncation", &config.dt, |&dt| Ok(at(lab, dt)))?;
    let columns = ["Δt (s)", "error of the method", "overtaken after, predicted", "measured"];
    let mut table = Table::new("rounding overtakes truncation", &columns);
    for (&dt, found) in config.dt.iter().zip(found) {
        let Some((truncation, predicted, measured)) = found else { continue };
        let shown = measured.map_or_else(|| Cell::absent("out of reach"), |n| Cell::rounded(n, 3));
        table.push([dt.into(), truncation.into(), Cell::rounded(predicted, 3), shown]);
        let Some(measured) = measured else { continue };
        record.find(Finding::predicted(
            format!("precision.crossover.{}", tag(dt)),
            format!(
                "velocity Verlet in f32 at Δt = {}: steps until rounding has left what the energy \
                 swings by, as a root mean square over {} orbits",
                seconds(dt, 3),
                count(ORBITS as u64)
            ),
            "steps",
            predicted,
            measured,
            Tolerance::relative(
                2.0 * ERRORS / (2.0 * ORBITS as f64).sqrt() + 0.1,
                "the steps go as the square of the drift, which m orbits show to 1/√(2m): four times \
                 twice that, and a tenth for the distance of the samples",
            ),
        ));
    }
    record.tables.push(table);
    Ok(())
}

/// The largest drift by truncation, the steps that are predicted, and those that were found.
fn at(lab: &Lab<'_>, dt: f64) -> Option<(f64, f64, Option<f64>)> {
    let one = InFloat::<_, f32>::new(VelocityVerlet, lab.config, dt)?;
    let local = one.rounding::<f64>(lab.effort.choose(400_000, 1_000_000, 4_000_000))?;
    let truncation = one.truncation();
    let predicted = local.steps_to(truncation);
    // Four times as far, and no more work than a million steps of four orbits.
    let reach = 4.0 * predicted;
    let random = one.rounds_at_random(f32::UNIT_ROUNDOFF);
    if !random || !(8.0..4e6 / ORBITS as f64).contains(&reach) {
        return Some((truncation, predicted, None));
    }
    let sampled = log_spaced_steps(reach as u64, PER_DECADE);
    let change = |from: &State<f32, 1>, to: &State<f32, 1>| one.change(from, to);
    let orbits = follow(&one.starts(ORBITS), &sampled, |s| one.step(s), change);
    let rms = |i: usize| {
        (orbits.iter().map(|orbit| orbit.seen[i].powi(2)).sum::<f64>() / ORBITS as f64).sqrt()
    };
    let crossed = (0..sampled.len()).find(|&i| rms(i) >= truncation);
    Some((truncation, predicted, crossed.map(|i| sampled[i] as f64)))
}
