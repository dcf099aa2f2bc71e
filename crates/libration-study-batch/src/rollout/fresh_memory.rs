//! The cost of a rollout into new memory, and its page faults.

use std::hint::black_box;

use libration::rl::{Environments, Rollout};
use libration_report::record::{Cell, Finding, Record, Relation, Table, Tolerance};
use libration_study::StudyError;

use super::cases::name;
use crate::bench::{
    Contestant, FEEDBACK, PAGE, RolloutCase, RolloutTask, count_faults, regulating, rollout, suited,
};
use crate::measurement::Measurement;

const CASES: [RolloutCase; 2] = [
    RolloutCase { task: RolloutTask::Regulate, environments: 1024, horizon: 512 },
    RolloutCase { task: RolloutTask::Regulate, environments: 4096, horizon: 1024 },
];

/// Tensors of the case: each may begin and end within a page.
const TENSORS: usize = 4;

/// Times rollouts into new tensors and into those of the rollout before, on one core.
pub(super) fn measure(
    measurement: &Measurement<'_>,
    record: &mut Record,
) -> Result<(), StudyError> {
    let columns =
        ["environments", "horizon", "tensors", "page faults", "transitions (10⁶/s)", "over used"];
    let mut table = Table::new("fresh and used tensors", &columns);
    for case in CASES.into_iter().filter(|case| case.check().is_ok()) {
        let plan = case.plan().writes(suited(case.bytes()));
        let mut all =
            Environments::new(regulating(), case.environments, 7, measurement.serial.clone())?;
        let mut anew = || -> Result<(), StudyError> {
            let mut tensors = Rollout::new(plan)?;
            all.rollout(FEEDBACK, &mut tensors)?;
            black_box(&tensors);
            Ok(())
        };
        let faults = count_faults(&mut anew)?;
        let fresh = Contestant::new(case.transitions() as f64, |times| {
            for _ in 0..times {
                // It went well before, with as much memory.
                let _ = anew();
            }
        });
        let [used, fresh] =
            measurement.sweep_rates([rollout(case, plan, &measurement.serial)?, fresh])?;
        let share = fresh.over(&used).median();
        let name = name(case);
        record.find(Finding::measured(
            format!("rollout.fresh.{name}"),
            format!(
                "{} × {}, one core: transitions a second into new tensors over those into tensors that were \
                 written before",
                case.environments, case.horizon
            ),
            "1",
            share,
        ));
        if let Some(faults) = faults {
            record.find(Finding::related(
                format!("rollout.faults.{name}"),
                format!(
                    "page faults of a rollout of {} × {} into new tensors; at most one for each page of 4 KiB",
                    case.environments, case.horizon
                ),
                "1",
                Relation::AtMost,
                (case.bytes() / PAGE + TENSORS) as f64,
                faults as f64,
                Tolerance::relative(
                    0.05,
                    "other threads of the process; fewer where the system hands out larger pages",
                ),
            ));
        }
        let sizes = [case.environments, case.horizon].map(|n| Cell::from(n as u64));
        let told =
            |faults: Option<u64>| faults.map_or_else(|| Cell::absent("not told"), Cell::from);
        for (what, faults, rate, over) in
            [("used", Cell::absent("—"), &used, 1.0), ("new", told(faults), &fresh, share)]
        {
            let own = [what.into(), faults, (rate.median() / 1e6).into(), over.into()];
            table.push(sizes.clone().into_iter().chain(own));
        }
    }
    record.tables.push(table);
    Ok(())
}
