//! Repeatability of runs with jitter and skew.

use libration::control::Jitter;
use libration_report::record::{Finding, Record, Tolerance};
use libration_study::{Lab, StudyError};

use super::{Clocks, DT, SEED, run, start};

const STEPS: u64 = 2000;

/// Counts the trajectories that two runs of one seed differ in, and those of another seed.
pub(super) fn measure(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let clocks = Clocks { skew: Jitter::Gaussian(0.01), jitter: 0.05 };
    let states = |seed: u64, count: usize| {
        let model = lab.config.oscillator.system();
        let seen = run(lab, model, clocks, (DT, seed), &vec![start(lab); count], &[STEPS])?;
        let states = seen.iter().flat_map(|s| s.directions().iter().take(8));
        Ok::<_, StudyError>(
            states.map(|s| [s.q[0].to_bits(), s.v[0].to_bits()]).collect::<Vec<_>>(),
        )
    };
    let (first, again, other) = (states(SEED, 8)?, states(SEED, 100)?, states(SEED + 1, 8)?);
    let differ =
        |others: &[[u64; 2]]| first.iter().zip(others).filter(|(a, b)| a != b).count() as f64;
    let exact = || Tolerance::exact("random numbers follow from seed, trajectory and step alone");
    record.find(Finding::predicted(
        "asynchrony.replay.same-seed",
        "of eight trajectories with jitter and rates of their own, alone and again among a hundred, with the same \
         seed: how many differ in any bit",
        "1",
        0.0,
        differ(&again),
        exact(),
    ));
    record.find(Finding::predicted(
        "asynchrony.replay.other-seed",
        "of eight such trajectories with another seed: how many differ",
        "1",
        8.0,
        differ(&other),
        exact(),
    ));
    Ok(())
}
