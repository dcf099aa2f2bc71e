//! What the bounds on rounding have in common.

use libration::integrator::{SUZUKI4, YOSHIDA4};
use libration::{Float, Method};

/// The sum of the sizes of the substeps of a step of length one: more than one where a composition
/// steps back. Terms of a step at `z` are bounded by `e^(z · path)`.
pub(super) fn path_of_unit_step(method: Method) -> f64 {
    match method {
        Method::Yoshida4 => YOSHIDA4.weights.iter().map(|w| w.abs()).sum(),
        Method::Suzuki4 => SUZUKI4.weights.iter().map(|w| w.abs()).sum(),
        _ => 1.0,
    }
}

/// The relative error that rounding may leave after `steps` steps of `dt`.
///
/// Roundings of a step are independent and add up like √n, with a coefficient that was measured
/// between 0.6 and 1.1 for Verlet (Brouwer 1937; Hairer, Lubich, Wanner, §VIII.5); 12 of them
/// cover RK4 and the largest of a million values, and `e^z` the terms of a step that cancel at
/// large `z = ωΔt` (of a composition, with the sum of the sizes of its substeps for z). Two kinds of
/// run are biased and add up like n: textbook Verlet, and a `Δt` of so few bits that its
/// products are exact.
pub(super) fn rounding_of_run(method: Method, omega: f64, dt: f64, steps: u64) -> f64 {
    let short = dt.to_bits().trailing_zeros() >= 30;
    let biased = short || method == Method::TextbookVerlet;
    let n = steps as f64;
    let count = if biased { n } else { n.sqrt() };
    let path = omega * dt * path_of_unit_step(method);
    12.0 * f64::UNIT_ROUNDOFF * path.exp() * count.max(1.0)
}
