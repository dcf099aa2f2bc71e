//! Repeatability of runs with jitter.

use libration::control::clock::{Gaussian, Jittered};
use libration::ensemble::{All, Setup};
use libration::integrator::VelocityVerlet;
use libration::system::BaselineOnly;
use libration_report::record::{Finding, Record, Tolerance};
use libration_study::{Lab, StudyError};

use super::{SEED, start};
use crate::loop_ensemble::run_snapshots;

const STEPS: u64 = 10_000;

/// Counts the bits that two runs of one seed differ in, and those of another seed.
pub(super) fn measure(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let setup = Setup::new(All(BaselineOnly(lab.config.oscillator.system())), VelocityVerlet)
        .clock(Jittered(Gaussian(0.05)));
    let dt = 0.1 / lab.config.oscillator.omega();
    let run = |seed: u64, count: usize| {
        let seen = run_snapshots(lab, setup, (dt, seed), &vec![start(lab); count], &[STEPS])?;
        let states = seen.iter().flat_map(|s| s.directions().iter().take(8));
        Ok::<_, StudyError>(states.map(|s| [s.q[0], s.v[0]]).collect::<Vec<_>>())
    };
    let (first, again, other) = (run(SEED, 8)?, run(SEED, 100)?, run(SEED + 1, 8)?);
    let differ = |a: &[[f64; 2]], b: &[[f64; 2]]| {
        let differs = |(a, b): &(&[f64; 2], &[f64; 2])| a.map(f64::to_bits) != b.map(f64::to_bits);
        a.iter().zip(b).filter(differs).count() as f64
    };
    let exact = || Tolerance::exact("random numbers follow from seed, trajectory and step alone");
    record.find(Finding::predicted(
        "jitter.replay.same-seed",
        "of eight trajectories, alone and again among a hundred, with the same seed: how many differ in any bit",
        "1",
        0.0,
        differ(&first, &again),
        exact(),
    ));
    record.find(Finding::predicted(
        "jitter.replay.other-seed",
        "of eight trajectories with another seed: how many differ",
        "1",
        8.0,
        differ(&first, &other),
        exact(),
    ));
    Ok(())
}
