//! Changes that preserve every bit.

use libration::ensemble::{All, InstructionSet, Moments};
use libration::integrator::SymplecticEuler;
use libration::system::Oscillator;
use libration::{Ensemble, State};
use libration_report::record::{Finding, Record, Tolerance};
use libration_study::{Lab, StudyError};

use super::runs::{COUNT, DT, SPRING, differing, run_perturbed, run_plain, start, steps};
use crate::bit_comparison::add_row;

/// Threads that are tried.
pub(super) const THREADS: [usize; 4] = [1, 2, 3, 4];

/// Compares runs that must be the same.
pub(super) fn measure(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let whole = run_plain(lab, COUNT, lab.alone()?, 1)?;
    let noisy = run_perturbed(lab, COUNT, lab.alone()?, 1)?;
    let again = differing(&whole, &run_plain(lab, COUNT, lab.alone()?, 1)?);
    same(record, "repeat", "nothing: the same run again", COUNT, again);

    let (mut threads, mut noisy_threads) = (0, 0);
    for count in THREADS {
        lab.check()?;
        // With work for each of them, however little there is.
        let execution = lab.alone()?.threads(count)?.worth(1);
        threads += differing(&whole, &run_plain(lab, COUNT, execution.clone(), 1)?);
        noisy_threads += differing(&noisy, &run_perturbed(lab, COUNT, execution, 1)?);
    }
    same(record, "threads", "1, 2, 3 and 4 threads", THREADS.len() * COUNT, threads);
    let what = "1, 2, 3 and 4 threads, with jitter, skew and latency";
    same(record, "threads-shaken", what, THREADS.len() * COUNT, noisy_threads);

    let sets: Vec<InstructionSet> = InstructionSet::available().collect();
    let mut others = 0;
    for &set in &sets {
        let execution = lab.alone()?.instructions(set)?;
        others += differing(&whole, &run_plain(lab, COUNT, execution, 1)?);
    }
    let names: Vec<&str> = sets.iter().map(|set| set.name()).collect();
    let what = format!("the instruction set: {}", names.join(", "));
    same(record, "instructions", &what, sets.len() * COUNT, others);

    let calls = differing(&whole, &run_plain(lab, COUNT, lab.alone()?, 7)?);
    same(record, "calls", "steps in seven calls in place of one", COUNT, calls);
    let few = COUNT / 5;
    let fewer = differing(&whole[..few], &run_plain(lab, few, lab.alone()?, 1)?);
    same(record, "count", "a fifth of the trajectories, the same ones", few, fewer);
    let fewer = differing(&noisy[..few], &run_perturbed(lab, few, lab.alone()?, 1)?);
    let what = "a fifth of the trajectories, the same ones, with jitter, skew and latency";
    same(record, "count-shaken", what, few, fewer);

    let mut means = Vec::new();
    for count in THREADS {
        means.push(mean(lab, count)?);
    }
    let differ = means.iter().filter(|mean| **mean != means[0]).count();
    same(record, "moments", "1, 2, 3 and 4 threads, mean and variance", THREADS.len(), differ);
    Ok(())
}

/// Adds the finding that no result differs.
fn same(record: &mut Record, id: &str, changed: &str, compared: usize, differ: usize) {
    let reason = "every lane takes the steps of a lone trajectory, whose operations and their order are fixed; \
                  what is random is drawn by address";
    let finding = Finding::predicted(
        format!("determinism.kept.{id}"),
        format!("results that differ in any bit; changed: {changed}"),
        "1",
        0.0,
        differ as f64,
        Tolerance::exact(reason),
    );
    add_row(record, changed, compared, finding);
}

/// Mean position and velocity over all trajectories in the end, and their standard deviations, as bits.
fn mean(lab: &Lab<'_>, threads: usize) -> Result<Vec<u64>, StudyError> {
    let state = |n| {
        let [q, v] = start(n);
        State { q: [q], v: [v] }
    };
    let system = Oscillator { omega2: SPRING.omega2 as f32 };
    let execution = lab.alone()?.threads(threads)?.worth(1);
    let mut all = Ensemble::<f32, 1>::from_fn(COUNT, execution, state)?;
    let count = steps(lab);
    let watch = |_| Moments::<1>::new();
    let moments = all.observe(SymplecticEuler, All(system), All(DT), count, count, watch)?;
    let merged = Moments::merged(moments);
    let bits = merged
        .summaries()
        .flat_map(|s| [s.mean.q[0], s.mean.v[0], s.variance.q[0], s.variance.v[0]])
        .map(f64::to_bits);
    Ok(bits.collect())
}
