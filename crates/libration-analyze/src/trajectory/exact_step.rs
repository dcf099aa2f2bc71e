//! Exact steps of linear systems.

use libration::Model;
use libration::integrator::Exact;

use super::TrajectoryError;

/// The exact integrator of `model` for a time step of `dt` seconds; the longest step is `longest` times as long.
///
/// # Errors
/// If the longest step turns by more than [`Exact::MOST_ANGLE`].
pub(super) fn exact<const D: usize>(
    model: &impl Model<D>,
    dt: f64,
    longest: f64,
) -> Result<Exact, TrajectoryError> {
    Exact::new(*model, longest * dt).ok_or_else(|| {
        let most = Exact::MOST_ANGLE / Exact::angle(*model, longest).unwrap_or(f64::NAN);
        let (value, turned) = (format!("{dt:?}"), Exact::MOST_ANGLE);
        let allowed =
            format!("at most {most:?}, where the longest exact step turns by {turned} radians");
        TrajectoryError::Value { name: "dt", value, allowed }
    })
}
