//! Changes that preserve every bit of a rollout.

use std::ops::Range;

use libration::State;
use libration::control::Jitter;
use libration::control::clock::{Gaussian, Jittered, Skewed, Uniform};
use libration::ensemble::{All, Execution, InstructionSet};
use libration::integrator::SymplecticEuler;
use libration::rl::policy::{GaussianExploration, Linear};
use libration::rl::sensor::Noisy;
use libration::rl::start::UniformStart;
use libration::rl::task::Regulate;
use libration::rl::variation::RandomParameters;
use libration::rl::{
    Delays, Distribution, Environment, Environments, Layout, Plan, Rollout, World, Writes,
};
use libration::system::Oscillator;
use libration_report::record::{Finding, Record, Tolerance};
use libration_study::{Lab, StudyError};

use crate::bit_comparison;
use crate::bit_comparison::add_row;
use crate::measurement::Measurement;

/// Environments that are compared: no multiple of what the engine steps together.
const COUNT: usize = 1500;

/// The numbers of environments among which the first are the same.
const COUNTS: [usize; 4] = [1, 77, 512, 2 * COUNT];

/// Boundaries of shards.
const SHARDS: [usize; 5] = [0, 1, 64, 500, COUNT];

/// Threads that are tried.
const THREADS: [usize; 4] = [1, 2, 3, 4];

const SEED: u64 = 9;

/// Actions of each environment.
fn horizon(lab: &Lab<'_>) -> usize {
    lab.effort.choose(150, 500, 2000)
}

/// All that an environment can suffer from: random starts, time limits, late observations and actions, clocks that are wrong
/// and uneven, noise, and another spring and bound in every episode.
fn world() -> impl World<f32, 2, 1> {
    let corner = |sign: f64| State { q: [sign], v: [2.0 * sign] };
    let task = Regulate { position: 1.0, velocity: 0.1, effort: 0.01, bound: 1.2 };
    let spring = All(Oscillator { omega2: 10.0 });
    Environment::new(spring, SymplecticEuler, 0.06, task, UniformStart(corner(-1.0), corner(1.0)))
        .limit(60)
        .delays(Delays { observation: [0, 2], action: [1, 3] })
        .clock((Skewed(Jitter::Uniform(0.01)), Jittered(Gaussian(0.2))))
        .sensor(Noisy([Uniform(0.05), Uniform(0.1)]))
        .variation(RandomParameters {
            numbers: [Distribution::Uniform(8.0, 12.0), Distribution::Uniform(1.0, 1.4)],
            apply: |[omega2, bound]: [f32; 2], _: Oscillator<f32>, task: Regulate| {
                (Oscillator { omega2 }, Regulate { bound: bound.into(), ..task })
            },
        })
}

/// Feedback, and noise to explore with.
const POLICY: GaussianExploration<Linear<2, 1>, 1> =
    GaussianExploration { policy: Linear { weights: [[-3.0, 0.5]], bias: [0.25] }, sigma: [0.5] };

/// A rollout of these environments over so many steps.
pub(super) fn rolled(
    which: Range<usize>,
    seed: u64,
    execution: Execution,
    plans: &[Plan],
) -> Result<Vec<Rollout<f32, 2, 1>>, StudyError> {
    let mut all = Environments::shard(world(), which.start, which.len(), seed, execution)?;
    let one = |&plan: &Plan| {
        let mut rollout = Rollout::new(plan)?;
        all.rollout(POLICY, &mut rollout)?;
        Ok(rollout)
    };
    plans.iter().map(one).collect()
}

/// A rollout that is to be compared.
#[derive(Clone)]
struct Run {
    /// The number of the first environment.
    first: usize,
    count: usize,
    seed: u64,
    execution: Execution,
    layout: Layout,
    writes: Writes,
    /// Number of consecutive rollouts of the horizon.
    calls: usize,
}

impl Run {
    fn which(&self) -> Range<usize> {
        self.first..self.first + self.count
    }

    /// A hash for each environment of all that it saw and did and what came of it.
    fn hashes(&self, lab: &Lab<'_>) -> Result<Vec<u64>, StudyError> {
        let whole = horizon(lab);
        let plan = |call: usize| {
            let part = whole * (call + 1) / self.calls - whole * call / self.calls;
            let plan = Plan::new(part, self.count).truncated().log_probabilities();
            plan.layout(self.layout).writes(self.writes)
        };
        let plans: Vec<Plan> = (0..self.calls).map(plan).collect();
        let rollouts = rolled(self.which(), self.seed, self.execution.clone(), &plans)?;
        let mut hashes = vec![OFFSET; self.count];
        for rollout in &rollouts {
            for t in 0..rollout.plan().horizon {
                for (n, hash) in hashes.iter_mut().enumerate() {
                    let at = t * self.count + n;
                    let [q, v] = rollout.seen(t, n).map(f32::to_bits);
                    let [action] = rollout.done(t, n).map(f32::to_bits);
                    let reward = rollout.reward()[at].to_bits();
                    let probability = rollout.log_probability()[at].to_bits();
                    let over = u32::from(rollout.terminated()[at]);
                    let cut = u32::from(rollout.truncated()[at]);
                    for word in [q, v, action, reward, probability, over, cut] {
                        *hash = hashed(*hash, word);
                    }
                }
            }
        }
        Ok(hashes)
    }
}

const OFFSET: u64 = 0xcbf2_9ce4_8422_2325;

/// G. Fowler, L. C. Noll, K.-P. Vo, D. Eastlake, *The FNV non-cryptographic hash algorithm*, FNV-1a of 64 bits.
fn hashed(hash: u64, word: u32) -> u64 {
    const PRIME: u64 = 0x100_0000_01b3;
    let step = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(PRIME);
    word.to_le_bytes().into_iter().fold(hash, step)
}

/// Returns the number of different results.
fn differing(a: &[u64], b: &[u64]) -> usize {
    a.iter().zip(b).filter(|(a, b)| a != b).count()
}

/// Compares rollouts that must be the same, and one that must not.
pub(super) fn measure(
    measurement: &Measurement<'_>,
    record: &mut Record,
) -> Result<(), StudyError> {
    let lab = measurement.lab;
    bit_comparison::begin(record);
    let run = Run {
        first: 0,
        count: COUNT,
        seed: SEED,
        execution: measurement.serial.clone(),
        layout: Layout::Interleaved,
        writes: Writes::Plain,
        calls: 1,
    };
    let whole = run.hashes(lab)?;
    let differ = |runs: Vec<Run>| -> Result<[usize; 2], StudyError> {
        let mut sums = [0, 0];
        for run in runs {
            lab.check()?;
            sums[0] += run.count.min(COUNT);
            sums[1] += differing(&whole[run.first..], &run.hashes(lab)?);
        }
        Ok(sums)
    };
    same(record, "repeat", "nothing: the same rollout again", differ(vec![run.clone()])?);
    let mut runs = Vec::new();
    for count in THREADS {
        // With work for each of them, however little there is.
        let execution = measurement.serial.clone().threads(count)?.worth(1);
        runs.push(Run { execution, ..run.clone() });
    }
    same(record, "threads", "1, 2, 3 and 4 threads", differ(runs)?);
    let fewer = COUNTS.map(|count| Run { count, ..run.clone() });
    let what = format!("{COUNT} environments: 1, 77, 512 and {} instead", 2 * COUNT);
    same(record, "environments", &what, differ(fewer.to_vec())?);
    let shards = SHARDS.windows(2).map(|ends| Run {
        first: ends[0],
        count: ends[1] - ends[0],
        ..run.clone()
    });
    let what = "all in one: shards of 1, 63, 436 and 1000 environments";
    same(record, "shards", what, differ(shards.collect())?);
    let mut runs = Vec::new();
    for set in InstructionSet::available() {
        let execution = measurement.serial.clone().instructions(set)?;
        runs.push(Run { execution, ..run.clone() });
    }
    let names: Vec<&str> = InstructionSet::available().map(InstructionSet::name).collect();
    let what = format!("the instruction set: {}", names.join(", "));
    same(record, "instructions", &what, differ(runs)?);
    let planes = Run { layout: Layout::Planes, ..run.clone() };
    same(record, "layout", "the layout: planes", differ(vec![planes.clone()])?);
    let past = [run.clone(), planes].map(|run| Run { writes: Writes::Past, ..run });
    let what = "the way to write: past the caches, in both layouts";
    same(record, "writes", what, differ(past.to_vec())?);
    let calls = Run { calls: 7, ..run.clone() };
    same(record, "calls", "seven rollouts in place of one", differ(vec![calls])?);

    let [compared, other] = differ(vec![Run { seed: SEED + 1, ..run }])?;
    let finding = Finding::predicted(
        "rollout.broken.seed",
        "environments whose rollout differs in any bit; changed: the seed",
        "1",
        compared as f64,
        other as f64,
        Tolerance::exact("no two of hundreds of random steps agree in all bits by accident"),
    );
    add_row(record, "the seed", compared, finding);
    Ok(())
}

/// Adds the finding that no result differs.
fn same(record: &mut Record, id: &str, what: &str, [compared, differ]: [usize; 2]) {
    let reason = "what an environment does follows from its number, the seed and the step; operations and their order \
                  are fixed, and what is random is drawn by address";
    let finding = Finding::predicted(
        format!("rollout.kept.{id}"),
        format!("environments whose rollout differs in any bit, by hash; changed: {what}"),
        "1",
        0.0,
        differ as f64,
        Tolerance::exact(reason),
    );
    add_row(record, what, compared, finding);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hash_is_that_of_its_authors() {
        // Their test vector of the string “foob”.
        assert_eq!(hashed(OFFSET, u32::from_le_bytes(*b"foob")), 0xdd12_0e79_0c25_12af);
        assert_eq!(differing(&[1, 2, 3], &[1, 5, 3, 4]), 1);
    }
}
