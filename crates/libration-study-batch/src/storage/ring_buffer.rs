//! Content of a full replay buffer, and the distribution of draws.

use libration::replay::{Batch, Capacity, Draw, Lookahead, ReplayBuffer};
use libration::rl::policy::Random;
use libration::rl::{Environments, Plan, Rollout};
use libration_report::record::{Finding, Record, Relation, Tolerance};
use libration_study::{Lab, StudyError};

use crate::bench::regulating;

const ENVIRONMENTS: usize = 64;
/// Steps that are kept.
const STEPS: usize = 64;
/// Steps of a rollout, of which no whole number fills the buffer.
const ROLLOUT: usize = 24;
/// Rollouts that are inserted: the buffer is full three times and more.
const INSERTED: u64 = 9;
/// Transitions of a batch.
const BATCH: usize = 1024;
/// How far statistics may be off, in their standard deviations: one in two millions is further.
const DEVIATIONS: f64 = 5.0;

/// The source's transitions: position and velocity, an action and a reward in `f32`, and a flag.
type Store = ReplayBuffer<f32>;
const SIZES: [usize; 2] = [2, 1];
const BYTES: usize = 4 * size_of::<f32>() + 1;

/// Inserts, looks, and draws.
pub(super) fn measure(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let execution = lab.alone()?;
    let capacity = Capacity::new(STEPS, ENVIRONMENTS);
    let mut plain = Store::new(SIZES, capacity)?;
    let mut weighed = Store::new(SIZES, capacity.priorities())?;
    let mut all = Environments::new(regulating(), ENVIRONMENTS, 7, execution.clone())?;
    let mut rollout = Rollout::new(Plan::new(ROLLOUT, ENVIRONMENTS).truncated())?;
    let mut next = vec![0.0; 2 * ENVIRONMENTS];
    let before = plain.bytes().len();
    for _ in 0..INSERTED {
        all.rollout(Random::between([-1.0], [1.0]), &mut rollout)?;
        all.observe(&mut next)?;
        plain.insert(&rollout, &next, &execution)?;
        weighed.insert(&rollout, &next, &execution)?;
    }
    let inserted = INSERTED * (ROLLOUT * ENVIRONMENTS) as u64;
    let newest = inserted - (STEPS * ENVIRONMENTS) as u64;
    let kept = (0..inserted).filter(|&number| plain.contains(number));
    let (old, new): (Vec<u64>, Vec<u64>) = kept.partition(|&number| number < newest);
    let exact = || Tolerance::exact("they are counted");
    let steps = format!("{STEPS} steps of {ENVIRONMENTS} environments");
    for (id, text, unit, predicted, measured) in [
        (
            "storage.circle.new",
            format!("the newest transitions that a buffer of {steps} holds after {inserted}"),
            "1",
            (STEPS * ENVIRONMENTS) as f64,
            new.len() as f64,
        ),
        ("storage.circle.old", "older ones that it holds".to_owned(), "1", 0.0, old.len() as f64),
        (
            "storage.circle.bytes",
            "bytes by which it has grown meanwhile".to_owned(),
            "B",
            0.0,
            (plain.bytes().len() - before) as f64,
        ),
    ] {
        record.find(Finding::predicted(id, text, unit, predicted, measured, exact()));
    }
    each(record)?;
    odds(lab, record, &plain, &mut weighed)
}

/// Bytes of a transition, as buffers of a million and of two differ.
fn each(record: &mut Record) -> Result<(), StudyError> {
    const KEPT: usize = 1_000_000;
    let [one, two] = [KEPT, 2 * KEPT].map(|kept| {
        // No more room for ends in the larger one.
        Capacity::new(kept / ENVIRONMENTS, ENVIRONMENTS).ends(KEPT).bytes(2, 1, size_of::<f32>())
    });
    let grown = (two? - one?) as f64 / (KEPT / ENVIRONMENTS * ENVIRONMENTS) as f64;
    let text = "bytes of each further transition of a replay buffer, in which no observation is kept twice";
    // Fields begin with pages.
    let reason = "a page for each of five fields";
    let tolerance = Tolerance::absolute(5.0 * 4096.0 / KEPT as f64, reason);
    record.find(Finding::predicted("storage.bytes", text, "B", BYTES as f64, grown, tolerance));
    Ok(())
}

/// Tests the frequency of the draws of each transition.
fn odds(
    lab: &Lab<'_>,
    record: &mut Record,
    plain: &Store,
    weighed: &mut Store,
) -> Result<(), StudyError> {
    let execution = lab.alone()?;
    let kept = STEPS * ENVIRONMENTS;
    let first = weighed.inserted() * ENVIRONMENTS as u64 - kept as u64;
    let numbers: Vec<u64> = (first..first + kept as u64).collect();
    // From 1 to 17, without order.
    let priority = |i: usize| ((i * 7919) % 17 + 1) as f32;
    let priorities: Vec<f32> = (0..kept).map(priority).collect();
    let exponent = 0.6;
    weighed.update(&numbers, &priorities, exponent)?;
    let weight = |i: usize| f64::from(priority(i)).powf(exponent);
    let total: f64 = (0..kept).map(weight).sum();

    let batches = lab.effort.choose(1000, 4000, 20_000);
    let draws = (batches * BATCH as u64) as f64;
    let mut batch = Batch::<f32>::new(BATCH, SIZES);
    let mut counts = [vec![0.0; kept], vec![0.0; kept]];
    let ahead = Lookahead::default();
    for number in 0..batches {
        let draw = Draw { seed: 3, number };
        plain.sample(draw, ahead, &mut batch.columns(), &execution)?;
        tally(&mut counts[0], &batch.number, first);
        weighed.sample_prioritised(draw, ahead, 0.4, &mut batch.columns(), &execution)?;
        tally(&mut counts[1], &batch.number, first);
    }
    let freedom = (kept - 1) as f64;
    let tolerance = |what: &str| {
        let reason = format!("{DEVIATIONS} standard deviations √(2/k) of χ²/k, {what}");
        Tolerance::absolute(DEVIATIONS * (2.0 / freedom).sqrt(), reason)
    };
    let text = "χ² for each degree of freedom, of how often each transition is drawn uniformly";
    let square = chi_square(&counts[0], |_| draws / kept as f64) / freedom;
    let because = tolerance("of independent draws");
    record.find(Finding::predicted("storage.odds.uniform", text, "1", 1.0, square, because));
    let text =
        "the same of draws by priority, one in each of as many equal parts as the batch has draws";
    let square = chi_square(&counts[1], |i| draws * weight(i) / total) / freedom;
    let because = tolerance("which draws from parts do not exceed");
    let (relation, id) = (Relation::AtMost, "storage.odds.prioritised");
    record.find(Finding::related(id, text, "1", relation, 1.0, square, because));
    Ok(())
}

fn tally(counts: &mut [f64], numbers: &[u64], first: u64) {
    for number in numbers {
        counts[(number - first) as usize] += 1.0;
    }
}

/// Pearson's statistic of counts beside what is expected of each.
fn chi_square(counts: &[f64], expected: impl Fn(usize) -> f64) -> f64 {
    let each = counts.iter().enumerate();
    each.map(|(i, count)| (count - expected(i)).powi(2) / expected(i)).sum()
}
