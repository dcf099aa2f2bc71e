//! Energy with clocks of different rates: a separate band for each trajectory.

use libration::State;
use libration::analysis::{EnergyBand, UpdateMatrix};
use libration::control::Jitter;
use libration::integrator::VelocityVerlet;
use libration_report::notation::count;
use libration_report::record::{Finding, Record, Relation, Series, Tolerance};
use libration_study::{Lab, StudyError, log_spaced_steps};

use super::{Clocks, SEED, run, start};

/// `ωΔt`, and the deviation of the rates.
const Z: f64 = 0.3;
const RMS: f64 = 0.05;

/// Runs clocks that differ for long.
pub(super) fn measure(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let model = lab.config.oscillator.system();
    let dt = Z / lab.config.oscillator.omega();
    let steps = lab.effort.choose(10_000, 1_000_000, 1_000_000);
    let at = log_spaced_steps(steps, 12.0);
    let begin = start(lab);
    let clocks = Clocks::skewed(Jitter::Uniform(RMS));
    let seen = lab.part("energy under different rates", || {
        run(lab, model, clocks, (dt, SEED), &[begin; 64], &at)
    })?;
    let energy = |y: &State<f64, 1>| model.omega2 * y.q[0] * y.q[0] + y.v[0] * y.v[0];
    let first = energy(&begin);
    let largest: Vec<f64> = seen
        .iter()
        .map(|s| {
            let drifts = s.directions().iter().map(|y| (energy(y) / first - 1.0).abs());
            drifts.fold(0.0, f64::max)
        })
        .collect();
    // No rate is beyond √3 deviations; bands widen with the step.
    let fastest = dt * (1.0 + 3.0_f64.sqrt() * RMS);
    let step = UpdateMatrix::of_step(VelocityVerlet, model, &State::origin(), fastest);
    let Some(band) = EnergyBand::new(model, &step) else { return Ok(()) };
    let (low, high) = band.drift_after(&begin, steps);
    let bound = low.abs().max(high.abs());
    record.find(Finding::related(
        "asynchrony.energy.largest",
        format!(
            "velocity Verlet, ωΔt = {Z}, rates of 5 %: largest energy drift of 64 trajectories over {} steps",
            count(steps)
        ),
        "1",
        Relation::AtMost,
        bound,
        largest.iter().copied().fold(0.0, f64::max),
        Tolerance::absolute(
            f64::EPSILON * steps as f64,
            "the band of the fastest clock, and a rounding a step",
        ),
    ));
    record.series.push(
        Series::new("energy")
            .with("bound", "1", vec![bound; at.len()])
            .with("steps", "1", at.iter().map(|&n| n as f64).collect())
            .with("largest", "1", largest),
    );
    Ok(())
}
