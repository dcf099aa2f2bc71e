//! The layout of the tensor of observations.

use libration::rl::{Layout, Plan};
use libration_report::record::{Finding, Record, Tolerance};
use libration_study::StudyError;

use super::invariance::rolled;
use crate::measurement::Measurement;

/// Environments and steps of the rollout that is looked at.
const SIZE: usize = 3;

/// Looks up the positions that two environments saw first, in both layouts.
pub(super) fn measure(
    measurement: &Measurement<'_>,
    record: &mut Record,
) -> Result<(), StudyError> {
    let layouts = [("interleaved", Layout::Interleaved, 2), ("planes", Layout::Planes, 1)];
    for (name, layout, numbers) in layouts {
        let plan = Plan::new(SIZE, SIZE).truncated().log_probabilities().layout(layout);
        let rollouts = rolled(0..SIZE, 1, measurement.serial.clone(), &[plan])?;
        let Some(rollout) = rollouts.first() else { continue };
        let place = |n| {
            let [position, _] = rollout.seen(0, n);
            rollout.observation().iter().position(|&x| x.to_bits() == position.to_bits())
        };
        let stride = place(1).zip(place(0)).map(|(one, zero)| one as f64 - zero as f64);
        record.find(Finding::predicted(
            format!("rollout.stride.{name}"),
            format!(
                "{name}: bytes from the position of an environment to that of the next, in `f32`"
            ),
            "B",
            (numbers * size_of::<f32>()) as f64,
            stride.map_or(f64::NAN, |stride| stride * size_of::<f32>() as f64),
            Tolerance::exact("positions that were drawn at random stand there once"),
        ));
    }
    Ok(())
}
