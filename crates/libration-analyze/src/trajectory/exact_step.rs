//! Exact steps of linear systems.

use libration::integrator::Exact;
use libration_settings::equations::EquationSystem;

use super::TrajectoryError;
use super::error::value_error;
use crate::Stepping;

/// The exact integrator of a system for a time step of `dt` seconds; the longest step is `longest` times as long.
///
/// # Errors
/// If the system is not linear, or if the longest step turns by more than [`Exact::MOST_ANGLE`].
pub(super) fn exact(
    system: &EquationSystem,
    dt: f64,
    longest: f64,
) -> Result<Exact, TrajectoryError> {
    if !system.is_linear() {
        let value = format!("{} for {}", Stepping::EXACT, system.name);
        let allowed = "another integrator: exact steps require a linear system";
        return Err(value_error("integrator", value, allowed));
    }
    let fastest = fastest(system);
    Exact::of_angle(fastest * (longest * dt).abs()).ok_or_else(|| {
        let (most, turned) = (Exact::MOST_ANGLE / (fastest * longest), Exact::MOST_ANGLE);
        let allowed =
            format!("at most {most:?}, where the longest exact step turns by {turned} radians");
        value_error("dt", format!("{dt:?}"), allowed)
    })
}

/// The largest absolute eigenvalue of a linear system, in 1/s.
fn fastest(system: &EquationSystem) -> f64 {
    let dynamics = system.equations.dynamics();
    let degrees = dynamics.degrees();
    let mut accelerations = dynamics.accelerations().on::<f64>();
    let constant: Vec<f64> = accelerations.run(&[]).collect();
    Exact::fastest(2 * degrees, |state| {
        let rates = accelerations.run(state).zip(&constant).map(|(a, constant)| a - constant);
        state[degrees..].iter().copied().chain(rates).collect()
    })
}
