//! Stability of trajectories with clocks of different rates.

use libration::State;
use libration::control::Jitter;
use libration::system::Oscillator;
use libration_report::record::{Finding, Record, Series, Tolerance};
use libration_study::{Lab, StudyError};

use super::{Clocks, SEED, run, start};

/// `ωΔt` and the deviation of the rates: one clock of some is too fast.
const Z: f64 = 1.9;
const RMS: f64 = 0.06;

/// A trajectory that is unstable has left e¹⁰⁰ behind after the run; one that is stable does not come near it.
const LEFT: f64 = 100.0;

/// Distances of `z(1 + δ)` from 2 that the run does not tell: there growth is below `2√distance` a step.
const NEAR: f64 = 1e-3;

const STEPS: u64 = 4000;

/// Counts the trajectories that run away.
pub(super) fn measure(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let dt = Z / lab.config.oscillator.omega();
    let model = lab.config.oscillator.system();
    let clocks = Clocks::skewed(Jitter::Uniform(RMS));
    let count = lab.effort.choose(256, 1024, 4096);
    // What moves freely goes as far in a step as the step is long.
    let still = vec![State { q: [0.0], v: [1.0] }; count];
    let lengths = run(lab, Oscillator { omega2: 0.0 }, clocks, (dt, SEED), &still, &[1])?;
    let omega = lab.config.oscillator.omega();
    let z: Vec<f64> =
        lengths.iter().flat_map(|s| s.directions().iter().map(|y| omega * y.q[0])).collect();
    let begin = start(lab);
    let energy = |y: &State<f64, 1>| model.omega2 * y.q[0] * y.q[0] + y.v[0] * y.v[0];
    let starts = vec![begin; count];
    let seen = lab.part("which clocks are stable", || {
        run(lab, model, clocks, (dt, SEED), &starts, &[STEPS])
    })?;
    let first = energy(&begin).ln();
    let growth: Vec<f64> =
        seen.iter().flat_map(|s| s.logarithms(energy)).map(|x| x - first).collect();
    let near = z.iter().filter(|z| (*z - 2.0).abs() < NEAR).count() as f64;
    record.find(Finding::predicted(
        "asynchrony.stable.count",
        format!("velocity Verlet, ωΔt = {Z}, {count} clocks with rates of 6 %: how many trajectories run away"),
        "1",
        z.iter().filter(|z| **z > 2.0).count() as f64,
        growth.iter().filter(|g| **g > LEFT).count() as f64,
        Tolerance::absolute(near, "clocks so close to z(1 + δ) = 2 that the run is too short to tell"),
    ));
    let crossed = z
        .iter()
        .zip(&growth)
        .filter(|(z, growth)| (**z > 2.0) != (**growth > LEFT) && (**z - 2.0).abs() >= NEAR);
    record.find(Finding::predicted(
        "asynchrony.stable.others",
        "of these, clocks that are stable though z(1 + δ) is above 2, or not though it is below",
        "1",
        0.0,
        crossed.count() as f64,
        Tolerance::exact("each trajectory has a step of its own, and no other’s"),
    ));
    record.series.push(Series::new("stable").with("z", "1", z).with(
        "growth",
        "1",
        growth.iter().map(|g| g / 2.0 / STEPS as f64).collect(),
    ));
    Ok(())
}
