//! The time until the memory of this machine is full.

use libration_report::record::{Finding, Record};
use libration_study::{Lab, Machine, StudyError};

use super::BYTES;
use crate::bench::{RolloutCase, RolloutTask, rollout};
use crate::measurement::Measurement;

/// A rollout of the source's table that most caches hold.
const CASE: RolloutCase =
    RolloutCase { task: RolloutTask::Regulate, environments: 1024, horizon: 512 };

/// Times one rollout on all cores, and tells when it would have filled the memory.
pub(super) fn measure(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let measurement = Measurement::new(lab)?;
    let [rates] = measurement.sweep_rates([rollout(CASE, CASE.plan(), &measurement.parallel)?])?;
    record.find(Finding::measured(
        "memory.rate",
        format!(
            "transitions a second of {} environments over {} steps, on all cores",
            CASE.environments, CASE.horizon
        ),
        "1/s",
        rates.median(),
    ));
    if let Some(memory) = Machine::detect().memory {
        record.find(Finding::measured(
            "memory.installed",
            "memory of this machine",
            "B",
            memory as f64,
        ));
        record.find(Finding::measured(
            "memory.full",
            "time until rollouts at that rate have filled it, if all of them are kept",
            "s",
            memory as f64 / (BYTES as f64 * rates.median()),
        ));
    }
    Ok(())
}
