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
    let Some(fastest) = system.fastest_rate() else {
        let value = format!("{} for {}", Stepping::EXACT, system.name);
        let allowed = "another integrator: exact steps require a linear system";
        return Err(value_error("integrator", value, allowed));
    };
    Exact::of_angle(fastest * (longest * dt).abs()).ok_or_else(|| {
        let (most, turned) = (Exact::MOST_ANGLE / (fastest * longest), Exact::MOST_ANGLE);
        let allowed =
            format!("at most {most:?}, where the longest exact step turns by {turned} radians");
        value_error("dt", format!("{dt:?}"), allowed)
    })
}
