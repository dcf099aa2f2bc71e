//! The cost of draws and insertions against the size of a buffer.

use std::hint::black_box;

use libration::replay::{Batch, Capacity, Draw, Lookahead, ReplayBuffer};
use libration::rl::policy::{Constant, Random};
use libration::rl::{Environments, Plan, Rollout};
use libration_report::record::{Finding, Record, Series};
use libration_study::{Lab, StudyError};

use crate::bench::{Contestant, regulating, regulating_from};
use crate::measurement::Measurement;

/// Numbers of observations and actions.
const SIZES: [usize; 2] = [2, 1];
const ENVIRONMENTS: usize = 64;
const BATCH: usize = 256;
/// Steps of a rollout.
const ROLLOUT: usize = 16;

/// Columns of times, in nanoseconds for each transition.
pub(super) const COLUMNS: [(&str, &str); 3] =
    [("insert", "inserted"), ("uniform", "drawn uniformly"), ("prioritised", "drawn by priority")];

/// Times buffers of more and more transitions.
pub(super) fn measure(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let measurement = Measurement::new(lab)?;
    let most = lab.effort.choose(18, 22, 24);
    let kept: Vec<usize> = (12..=most).step_by(2).map(|power| 1 << power).collect();
    let mut columns = [const { Vec::new() }; COLUMNS.len()];
    for &kept in &kept {
        for (column, time) in columns.iter_mut().zip(times(&measurement, kept)?) {
            column.push(time);
        }
    }
    for ((name, done), times) in COLUMNS.iter().zip(&columns) {
        let (Some(first), Some(last)) = (times.first(), times.last()) else { continue };
        let [small, large] = [12, most].map(|power| format!("2^{power}"));
        record.find(Finding::measured(
            format!("storage.growth.{name}"),
            format!("time in which a transition is {done}, where {large} are kept, over that where {small} are"),
            "1",
            last / first,
        ));
    }
    let floats = kept.iter().map(|&kept| kept as f64).collect();
    let mut series = Series::new("draws").with("transitions", "1", floats);
    for ((name, _), times) in COLUMNS.iter().zip(columns) {
        series = series.with(*name, "ns", times);
    }
    record.series.push(series);
    Ok(())
}

/// Nanoseconds for each transition, in the order of [`COLUMNS`].
fn times(measurement: &Measurement<'_>, kept: usize) -> Result<[f64; COLUMNS.len()], StudyError> {
    let execution = &measurement.serial;
    let mut all = Environments::new(regulating(), ENVIRONMENTS, 7, execution.clone())?;
    let mut rollout = Rollout::new(Plan::new(ROLLOUT, ENVIRONMENTS).truncated())?;
    let mut next = vec![0.0; 2 * ENVIRONMENTS];
    let capacity = Capacity::new(kept / ENVIRONMENTS, ENVIRONMENTS);
    let mut plain = ReplayBuffer::<f32>::new(SIZES, capacity)?;
    let mut weighed = ReplayBuffer::<f32>::new(SIZES, capacity.priorities())?;
    // Twice around: what is written first costs faults of pages.
    for _ in 0..2 * kept / ENVIRONMENTS / ROLLOUT {
        all.rollout(Random::between([-1.0], [1.0]), &mut rollout)?;
        all.observe(&mut next)?;
        plain.insert(&rollout, &next, execution)?;
        weighed.insert(&rollout, &next, execution)?;
    }
    // At rest every rollout goes on where the one before ended, also if it is the same again.
    let mut still = Environments::new(regulating_from(0.0), ENVIRONMENTS, 7, execution.clone())?;
    let mut rollout = Rollout::new(Plan::new(ROLLOUT, ENVIRONMENTS).truncated())?;
    still.rollout(Constant([0.0]), &mut rollout)?;
    still.observe(&mut next)?;
    let mut inserted = ReplayBuffer::<f32>::new(SIZES, capacity)?;
    for _ in 0..2 * kept / ENVIRONMENTS / ROLLOUT {
        inserted.insert(&rollout, &next, execution)?;
    }
    let [mut one, mut two] = [(); 2].map(|()| Batch::<f32>::new(BATCH, SIZES));
    let [mut first, mut second] = [0, 0];
    let ahead = Lookahead::default();
    // All of it went well just now.
    let contestants = [
        Contestant::new((ROLLOUT * ENVIRONMENTS) as f64, |times| {
            for _ in 0..times {
                let _ = black_box(inserted.insert(&rollout, &next, execution));
            }
        }),
        Contestant::new(BATCH as f64, |times| {
            for _ in 0..times {
                first += 1;
                let draw = Draw { seed: 1, number: first };
                let _ = black_box(plain.sample(draw, ahead, &mut one.columns(), execution));
            }
        }),
        Contestant::new(BATCH as f64, |times| {
            for _ in 0..times {
                second += 1;
                let (draw, columns) = (Draw { seed: 1, number: second }, &mut two.columns());
                let _ = black_box(weighed.sample_prioritised(draw, ahead, 0.4, columns, execution));
            }
        }),
    ];
    Ok(measurement.sweep_rates(contestants)?.map(|rates| 1e9 / rates.median()))
}
