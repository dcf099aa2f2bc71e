//! Advantages and returns, relative to the rollouts that they read.

use std::hint::black_box;

use libration::ensemble::Execution;
use libration::rl::{Discounts, Environments, Estimates, Rollout};
use libration_report::record::{Record, Table};
use libration_study::StudyError;

use super::cases::{on, on_cores};
use crate::bench::{Contestant, FEEDBACK, RolloutCase, RolloutTask, regulating, rollout, suited};
use crate::measurement::{Measurement, aim};

const CASE: RolloutCase =
    RolloutCase { task: RolloutTask::Regulate, environments: 4096, horizon: 256 };

/// Of a transition a rollout writes 17 bytes past the caches. Advantages read 9, and write 8 that are fetched before: with 25
/// bytes to move, half the speed is the same class.
const WANTED: f64 = 0.5;

/// As learners have them.
const DISCOUNTS: Discounts = Discounts { rewards: 0.99, errors: 0.95 };

/// Races the two on one core and on all.
pub(super) fn measure(
    measurement: &Measurement<'_>,
    record: &mut Record,
) -> Result<(), StudyError> {
    let columns =
        ["threads", "rollout (10⁶ transitions/s)", "advantages (10⁶ transitions/s)", "ratio"];
    let mut table = Table::new("advantages", &columns);
    for execution in measurement.executions() {
        let threads = execution.thread_count();
        let plan = CASE.plan().writes(suited(CASE.bytes()));
        let contestants = [rollout(CASE, plan, execution)?, estimates(execution)?];
        let [rollouts, advantages] = measurement.sweep_rates(contestants)?;
        let ratio = advantages.over(&rollouts);
        let id = format!("rollout.advantages{}", on(threads));
        let text = format!(
            "{} × {}, {}: transitions a second of generalised advantages and returns over those of the rollout",
            CASE.environments,
            CASE.horizon,
            on_cores(threads)
        );
        aim(record, id, text, Some(WANTED), &ratio, "they move half again as many bytes");
        table.push([
            (threads as u64).into(),
            (rollouts.median() / 1e6).into(),
            (advantages.median() / 1e6).into(),
            ratio.median().into(),
        ]);
    }
    record.tables.push(table);
    Ok(())
}

fn estimates(execution: &Execution) -> Result<Contestant<'static>, StudyError> {
    let plan = CASE.plan().values();
    let mut all = Environments::new(regulating(), CASE.environments, 7, execution.clone())?;
    let mut rollout = Rollout::new(plan)?;
    all.rollout(FEEDBACK, &mut rollout)?;
    rollout.value_mut().fill(1.0);
    let next = vec![1.0; CASE.environments];
    let last = vec![0.0; rollout.finals().len()];
    let mut estimates = Estimates::new(plan)?;
    let execution = execution.clone();
    estimates.fill(DISCOUNTS, &rollout, &next, &last, &execution)?;
    Ok(Contestant::new(CASE.transitions() as f64, move |times| {
        for _ in 0..times {
            // It went well before, and nothing has changed.
            let _ = black_box(estimates.fill(DISCOUNTS, &rollout, &next, &last, &execution));
        }
    }))
}
