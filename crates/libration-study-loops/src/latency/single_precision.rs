//! A latency of one step compared with single precision.

use libration::integrator::SymplecticEuler;
use libration::system::Oscillator;
use libration::{Float, Integrator, State};
use libration_report::Record;
use libration_report::notation::{count, seconds};
use libration_report::record::{Finding, Relation, Tolerance};
use libration_study::source_report::{DT, STEPS};
use libration_study::{Lab, StudyError};

use super::late_force::{SHORT, START};
use super::loop_simulation::SPRING;

/// Compares what a step of latency and what single precision make of the same orbit. The findings of
/// [`late_force`](super::late_force) must be there.
pub(super) fn measure(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let strayed = lab.part("single precision", || Ok(strayed()))?;
    for ((name, n), strayed) in [("short", SHORT), ("long", STEPS)].into_iter().zip(strayed) {
        let late = record.finding(&format!("latency.force-1.{name}"))?;
        let (predicted, measured) = (late.predicted.unwrap_or(f64::NAN) - 1.0, late.measured - 1.0);
        let steps = n as f64;
        let angle = SPRING.omega2.sqrt() * DT * steps;
        // Beside the angle of rounded coefficients, what independent roundings leave: see `rounding.rs`.
        let bound = f32::UNIT_ROUNDOFF * (12.0 * steps.sqrt() + 8.0 * angle);
        record.find(Finding::related(
            format!("latency.single.{name}"),
            format!(
                "Symplectic Euler, Δt = {}, {} steps: farthest that single precision strays from double, in \
                 position",
                seconds(DT, 3),
                count(n)
            ),
            "m",
            Relation::AtMost,
            bound,
            strayed,
            Tolerance::exact("a bound: 12 roundings times √n, and 8 roundings of the angle ωt"),
        ));
        record.find(Finding::related(
            format!("latency.single.{name}-ratio"),
            format!(
                "how many times as much one step of latency adds to the amplitude in {} steps",
                count(n)
            ),
            "1",
            Relation::AtLeast,
            predicted / bound,
            measured / strayed,
            Tolerance::exact("a bound: the growth that theory gives, over the bound on rounding"),
        ));
    }
    Ok(())
}

/// The farthest that an orbit in single precision is from the same in double, over both horizons.
fn strayed() -> [f64; 2] {
    let single = Oscillator { omega2: SPRING.omega2 as f32 };
    let (mut rough, mut fine): (State<f32, 1>, State<f64, 1>) = (START.map(|x| x as f32), START);
    let (mut farthest, mut short) = (0.0_f64, 0.0);
    for step in 1..=STEPS {
        rough = SymplecticEuler.step(&single, rough, DT as f32);
        fine = SymplecticEuler.step(&SPRING, fine, DT);
        farthest = farthest.max((f64::from(rough.q[0]) - fine.q[0]).abs());
        if step == SHORT {
            short = farthest;
        }
    }
    [short, farthest]
}
