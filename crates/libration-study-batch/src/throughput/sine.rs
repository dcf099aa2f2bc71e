//! The pendulum with the sine of Libration, compared with the sine of the platform.

use std::hint::black_box;

use libration::analysis::DataFlow;
use libration::ensemble::All;
use libration::integrator::SymplecticEuler;
use libration::system::Pendulum;
use libration::{Ensemble, State, System};
use libration_report::notation::number;
use libration_report::record::{Finding, Record};
use libration_study::StudyError;

use super::fused::{RESIDENT, arithmetic, peak};
use crate::bench::{Contestant, PlatformPendulum};
use crate::measurement::{Measurement, aim};

/// Steps of a pass.
const STEPS: u64 = 16;

/// Least speedup over the sine of the platform.
const BAR: f64 = 8.0;

/// Races the two, and the independent arithmetic that the step and its sine amount to.
pub(super) fn measure(
    measurement: &Measurement<'_>,
    record: &mut Record,
) -> Result<(), StudyError> {
    let task = measurement.task(1);
    let omega2 = task.omega2 as f32;
    let flow =
        DataFlow::of_step::<_, 1>(SymplecticEuler, &Pendulum { omega2: task.omega2 }, task.dt);
    let limit = peak::<f32>(measurement, &flow)?.with(arithmetic(&DataFlow::of_sine32()));
    let [own, platform, limit] = measurement.compare_rates([
        contestant(measurement, Pendulum { omega2 })?,
        contestant(measurement, PlatformPendulum { omega2 })?,
        limit.contestant::<f32>(measurement.set()),
    ])?;
    let (ratio, most) = (own.over(&platform), limit.over(&platform).median());
    let id = "throughput.sine".to_owned();
    let text = "pendulum, symplectic Euler, f32, one core: steps a second with the sine of this program over \
                those of the same loop with the platform’s";
    let reason = format!(
        "multiplications and additions alone, all of them independent, would go to {} times, and the sine also works \
         on bits",
        number(most, 3)
    );
    aim(record, id, text.into(), Some(BAR), &ratio, &reason);
    record.find(Finding::measured(
        "throughput.sine.share",
        "pendulum, symplectic Euler, f32, one core: steps a second over those that independent multiplications \
         and additions amount to, without what the sine does with bits",
        "1",
        own.over(&limit).median(),
    ));
    record.find(Finding::measured(
        "throughput.sine.rate",
        "pendulum, symplectic Euler, f32, one core: steps a second with the sine of this program",
        "1/s",
        own.median(),
    ));
    Ok(())
}

fn contestant<'a, Sys: System<f32, 1> + Copy + Send + Sync + 'a>(
    measurement: &Measurement<'_>,
    system: Sys,
) -> Result<Contestant<'a>, StudyError> {
    let task = measurement.task(RESIDENT);
    let dt = task.dt as f32;
    // All swings, from small to nearly over the top.
    let start = |n| State { q: [3.0 * n as f32 / RESIDENT as f32], v: [0.0] };
    let mut ensemble = Ensemble::<f32, 1>::from_fn(RESIDENT, measurement.serial.clone(), start)?;
    Ok(Contestant::new(RESIDENT as f64 * STEPS as f64, move |times| {
        for _ in 0..times {
            // One value for all is never too few or too many.
            let outcome = ensemble.advance(SymplecticEuler, All(system), All(dt), STEPS);
            debug_assert_eq!(outcome, Ok(()));
        }
        black_box(ensemble.q(0));
    }))
}
