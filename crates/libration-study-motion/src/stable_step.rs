//! The largest stable time step of a method on the undamped oscillator.

use libration::Method;
use libration::analysis::SymbolicStep;
use libration::number::Wide;
use libration_study::StudyError;

/// Upper end of the search for a limit.
pub(crate) const HIGHEST: f64 = 8.0;

/// The first `z = ωΔt` at which `method` is unstable on the undamped oscillator: the end of its first
/// window of stability, if that begins at zero.
pub(crate) fn largest_stable(method: Method) -> Result<f64, StudyError> {
    let symbolic = SymbolicStep::new(method)
        .ok_or_else(|| StudyError::Exact(format!("deriving {}", method.title())))?;
    let first = symbolic.stability_windows().into_iter().find(|window| window.from.is_zero());
    Ok(first.map_or(0.0, |window| window.to.map_or(HIGHEST, Wide::to_f64)))
}
