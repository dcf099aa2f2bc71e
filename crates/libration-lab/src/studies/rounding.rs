//! What the bounds on rounding have in common.

use libration::Method;
use libration::integrator::{SUZUKI4, YOSHIDA4};

/// The sum of the sizes of the substeps of a step of length one: more than one where a composition
/// steps back. Terms of a step at `z` are bounded by `e^(z · path)`.
pub(super) fn path_of_unit_step(method: Method) -> f64 {
    match method {
        Method::Yoshida4 => YOSHIDA4.weights.iter().map(|w| w.abs()).sum(),
        Method::Suzuki4 => SUZUKI4.weights.iter().map(|w| w.abs()).sum(),
        _ => 1.0,
    }
}
