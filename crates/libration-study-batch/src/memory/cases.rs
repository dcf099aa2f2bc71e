//! Planned and allocated bytes of the rollouts of the source.

use libration::rl::{EnvironmentError, Plan, Rollout};
use libration_report::record::{Cell, Finding, Record, Table, Tolerance};
use libration_study::StudyError;

use super::{ACTION, BYTES, MB, MIB, OBSERVATION, bytes};
use crate::source_rollouts::{EXAMPLES, SourceRollout, TABLE};

/// Every rollout of which the source prints numbers, each once.
fn cases() -> impl Iterator<Item = SourceRollout> {
    TABLE.iter().map(|row| row.of).chain([EXAMPLES[1]])
}

/// Asks for the plan of each, and of what is allocated how much it is.
pub(super) fn measure(record: &mut Record) -> Result<(), StudyError> {
    let columns = [
        "environments",
        "horizon",
        "transitions",
        "bytes each",
        "planned (bytes)",
        "held (bytes)",
        "MB",
        "MiB",
        "the source’s “MB”",
    ];
    let mut table = Table::new("rollouts in memory", &columns);
    for case in cases() {
        let plan = Plan::new(case.horizon, case.environments);
        let planned = bytes(plan);
        let allocated = allocated_bytes(plan)?;
        let name = case.name();
        let exactly = || Tolerance::exact("whole numbers, of which doubles hold 2⁵³");
        let transitions = plan.transitions() as f64;
        record.find(Finding::predicted(
            format!("memory.{name}.transitions"),
            format!("transitions of {}, beside what the source prints", case.title()),
            "1",
            case.transitions as f64,
            transitions,
            exactly(),
        ));
        record.find(Finding::predicted(
            format!("memory.{name}"),
            format!("memory of {} transitions, as planned, beside {BYTES}·E·T", case.title()),
            "B",
            (BYTES * case.environments * case.horizon) as f64,
            planned,
            exactly(),
        ));
        if let Some(allocated) = allocated {
            record.find(Finding::predicted(
                format!("memory.{name}.held"),
                format!("memory that the tensors of {} transitions are", case.title()),
                "B",
                planned,
                allocated,
                exactly(),
            ));
        }
        table.push([
            (case.environments as u64).into(),
            (case.horizon as u64).into(),
            (transitions as u64).into(),
            ((planned / transitions) as u64).into(),
            (planned as u64).into(),
            allocated.map_or_else(|| Cell::absent("no room"), |bytes| (bytes as u64).into()),
            Cell::rounded(planned / MB, 5),
            Cell::rounded(planned / MIB, 5),
            case.megabytes.into(),
        ]);
    }
    record.tables.push(table);
    Ok(())
}

/// Bytes of all tensors of a rollout, if there is room for it. Nobody writes them, so that no page comes to be.
fn allocated_bytes(plan: Plan) -> Result<Option<f64>, StudyError> {
    let rollout = match Rollout::<f32, OBSERVATION, ACTION>::new(plan) {
        Ok(rollout) => rollout,
        Err(EnvironmentError::OutOfMemory { .. }) => return Ok(None),
        Err(error) => return Err(error.into()),
    };
    let numbers = [
        rollout.observation(),
        rollout.action(),
        rollout.reward(),
        rollout.log_probability(),
        rollout.value(),
    ];
    let flags = [rollout.terminated(), rollout.truncated()];
    let bytes = numbers.map(size_of_val).iter().chain(&flags.map(size_of_val)).sum::<usize>();
    Ok(Some(bytes as f64))
}
