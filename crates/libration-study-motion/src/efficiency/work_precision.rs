//! Errors in energy, phase and state against the work, from one run each.

use std::f64::consts::{PI, TAU};

use libration::analysis::{EnergyBand, OrbitError, SymbolicStep, UpdateMatrix};
use libration::simulation::{EnergyDrift, Sample, Simulator};
use libration::system::Oscillator;
use libration::{Elementary, Float, Method, Model, State, with_method};
use libration_report::Record;
use libration_report::record::{Finding, Relation, Series, Tolerance};
use libration_study::{Lab, StudyError};

use super::accuracy_target::steps_for;
use super::cost::Cost;
use crate::rounding::rounding_of_run;

/// Errors of one run: the largest relative drift of the energy, the largest angle between orbit and
/// solution in rad, and the largest distance between them relative to the amplitude.
#[derive(Clone, Copy, Debug)]
struct Errors {
    energy: f64,
    phase: f64,
    state: f64,
}

/// Every method at many steps over the same time.
pub(super) fn measure(
    lab: &Lab<'_>,
    costs: &[Cost],
    record: &mut Record,
) -> Result<(), StudyError> {
    let periods: u64 = lab.effort.choose(10, 100, 1000);
    let points = lab.effort.choose(9, 17, 33);
    let jobs: Vec<(Cost, f64)> = costs
        .iter()
        .flat_map(|&cost| {
            let (low, high) = (2e-3_f64.ln(), 1.4_f64.ln());
            let z = move |i| (low + (high - low) * f64::from(i) / f64::from(points - 1)).exp();
            (0..points).map(move |i| (cost, z(i)))
        })
        .collect();
    let what = format!("work and precision over {periods} periods");
    let start = super::start(lab.config);
    let found = lab.sweep(&what, &jobs, |&(cost, z)| {
        let steps = steps_for(periods, z);
        Ok((bounds(cost.method, &start, z, steps), run(cost.method, start, z, steps)?))
    })?;
    for (jobs, rows) in jobs.chunks(points as usize).zip(found.chunks(points as usize)) {
        let Some(&(cost, _)) = jobs.first() else { continue };
        series(record, periods, cost, jobs, rows);
    }
    Ok(())
}

fn series(
    record: &mut Record,
    periods: u64,
    cost: Cost,
    jobs: &[(Cost, f64)],
    rows: &[(Option<Errors>, Option<Errors>)],
) {
    let method = cost.method;
    let mut columns = [const { Vec::new() }; 9];
    let mut worst = 0.0_f64;
    for (&(_, z), (bound, measured)) in jobs.iter().zip(rows) {
        let nan = Errors { energy: f64::NAN, phase: f64::NAN, state: f64::NAN };
        let (b, m) = (bound.unwrap_or(nan), measured.unwrap_or(nan));
        let work = cost.evaluations as f64 * TAU / z;
        let time = cost.nanoseconds * TAU / z;
        let row = [z, work, time, b.energy, m.energy, b.phase, m.phase, b.state, m.state];
        columns.iter_mut().zip(row).for_each(|(column, x)| column.push(x));
        let steps = steps_for(periods, z);
        // The run, and the angle of rounded coefficients; z itself is rounded, too.
        let rounding =
            rounding_of_run(method, 1.0, z, steps) + 16.0 * f64::UNIT_ROUNDOFF * z * steps as f64;
        for (bound, measured) in [(b.energy, m.energy), (b.phase, m.phase), (b.state, m.state)] {
            worst = worst.max((measured - bound) / (1.0 + bound) / rounding);
        }
    }
    let mut series = Series::new(format!("work-{}", method.name()));
    let names = [
        ("z", "1"),
        ("force_evaluations_per_period", "1"),
        ("time_per_period", "ns"),
        ("energy_bound", "1"),
        ("energy", "1"),
        ("phase_bound", "rad"),
        ("phase", "rad"),
        ("state_bound", "1"),
        ("state", "1"),
    ];
    for ((name, unit), column) in names.into_iter().zip(columns) {
        series = series.with(name, unit, column);
    }
    record.series.push(series);
    record.find(Finding::related(
        format!("efficiency.{}.within-bounds", method.name()),
        format!(
            "{}: largest excess of an error in energy, phase or state over its bound at {} steps \
             over {periods} periods, in units of the rounding that it may carry",
            method.title(),
            jobs.len()
        ),
        "1",
        Relation::AtMost,
        1.0,
        worst,
        Tolerance::exact("the bound on rounding is the unit"),
    ));
}

/// Returns bounds of the errors over all phases of the orbit.
fn bounds(method: Method, start: &State<f64, 1>, z: f64, steps: u64) -> Option<Errors> {
    let unit = Oscillator { omega2: 1.0 };
    let step = UpdateMatrix::of_step(method, unit, start, z);
    let slip = OrbitError::new(&SymbolicStep::new(method)?, z)?;
    let (low, high) = EnergyBand::new(unit, &step)?.drift_after(start, steps);
    // Along an ellipse of axes κ : 1 the angle runs ahead of the phase by up to asin(tanh ln κ), and
    // may begin as far behind.
    let wobble = 2.0 * slip.ellipse.abs().tanh().asin();
    Some(Errors {
        energy: low.abs().max(high.abs()),
        phase: (steps as f64 * slip.phase.abs() + wobble).min(PI),
        state: slip.worst_error_within(steps),
    })
}

/// The errors of a simulation beside the exact rotation; none if it left the range of `f64`.
fn run(
    method: Method,
    start: State<f64, 1>,
    z: f64,
    steps: u64,
) -> Result<Option<Errors>, StudyError> {
    let unit = Oscillator { omega2: 1.0 };
    let system = Model::<1>::on::<f64>(&unit);
    let drift = EnergyDrift::new(system, &start);
    let mut errors = Errors { energy: 0.0, phase: 0.0, state: 0.0 };
    let ([q0], [v0]) = (start.q, start.v);
    let amplitude = q0.hypot(v0);
    let mut watch = |sample: &Sample<f64, 1>| {
        let State { q: [q], v: [v] } = sample.state;
        let angle = sample.step as f64 * z;
        let (sin, cos) = (Elementary::sin(angle), Elementary::cos(angle));
        let exact = (q0 * cos + v0 * sin, v0 * cos - q0 * sin);
        let (dot, cross) = (q * exact.0 + v * exact.1, q * exact.1 - v * exact.0);
        errors.energy = errors.energy.max(drift.of(&sample.state).abs());
        errors.phase = errors.phase.max(cross.atan2(dot).abs());
        errors.state = errors.state.max((q - exact.0).hypot(v - exact.1) / amplitude);
    };
    let finished = with_method!(method, |m| {
        Simulator::new(system, m, start, z)?.run(steps, &mut watch).is_ok()
    });
    Ok(finished.then_some(errors))
}
