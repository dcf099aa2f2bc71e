//! The pendulum with the project's sine, beside the same loop with the platform's.

use std::hint::black_box;

use libration::ensemble::All;
use libration::integrator::SymplecticEuler;
use libration::system::Pendulum;
use libration::{Ensemble, State, System};

use super::desk::{Desk, judge};
use super::fused::RESIDENT;
use crate::bench::{Contestant, PlatformPendulum};
use crate::record::{Finding, Record};
use crate::study::StudyError;

/// Steps of a pass.
const STEPS: u64 = 16;

/// Races the two.
pub(super) fn measure(desk: &Desk<'_>, record: &mut Record) -> Result<(), StudyError> {
    let omega2 = desk.task(1).omega2 as f32;
    let own = contestant(desk, Pendulum { omega2 })?;
    let platform = contestant(desk, PlatformPendulum { omega2 })?;
    let [own, platform] = desk.race([own, platform])?;
    judge(
        record,
        "throughput.sine".into(),
        "pendulum, symplectic Euler, f32, one core: steps a second with the sine of this program over \
         those of the same loop with the platform’s"
            .into(),
        // How fast the platform's sine is no theory tells.
        None,
        &own.over(&platform),
    );
    record.find(Finding::measured(
        "throughput.sine.rate",
        "pendulum, symplectic Euler, f32, one core: steps a second with the sine of this program",
        "1/s",
        own.median(),
    ));
    Ok(())
}

fn contestant<'a, Sys: System<f32, 1> + Copy + Send + Sync + 'a>(
    desk: &Desk<'_>,
    system: Sys,
) -> Result<Contestant<'a>, StudyError> {
    let task = desk.task(RESIDENT);
    let dt = task.dt as f32;
    // All swings, from small to nearly over the top.
    let start = |n| State { q: [3.0 * n as f32 / RESIDENT as f32], v: [0.0] };
    let mut ensemble = Ensemble::<f32, 1>::from_fn(RESIDENT, desk.serial.clone(), start)?;
    Ok(Contestant::new(RESIDENT as f64 * STEPS as f64, move |times| {
        for _ in 0..times {
            // One value for all is never too few or too many.
            let outcome = ensemble.advance(SymplecticEuler, All(system), All(dt), STEPS);
            debug_assert_eq!(outcome, Ok(()));
        }
        black_box(ensemble.q(0));
    }))
}
