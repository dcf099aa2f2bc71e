//! Shared parts of the bounds on rounding.

use libration::analysis::UpdateMatrix;
use libration::integrator::{SUZUKI4, YOSHIDA4};
use libration::number::Wide;
use libration::system::Oscillator;
use libration::{Elementary, Float, Method, State};

/// The sum of the sizes of the substeps of a step of length one: more than one where a composition
/// steps back. Terms of a step at `z` are bounded by `e^(z · path)`.
pub(super) fn path_of_unit_step(method: Method) -> f64 {
    match method {
        Method::Yoshida4 => YOSHIDA4.weights.iter().map(|w| w.abs()).sum(),
        Method::Suzuki4 => SUZUKI4.weights.iter().map(|w| w.abs()).sum(),
        Method::Splitting(table) => table.coefficients.path(),
        _ => 1.0,
    }
}

/// The number of substeps of a step: a composition rounds as often as all of them.
pub(super) fn substeps(method: Method) -> usize {
    match method {
        Method::Yoshida4 => YOSHIDA4.weights.len(),
        Method::Suzuki4 => SUZUKI4.weights.len(),
        Method::Splitting(table) => table.coefficients.kicks(),
        _ => 1,
    }
}

/// How many times the rounding of one step `n` steps at `z` may leave: `√n` where their roundings are
/// independent (Brouwer 1937; Hairer, Lubich, Wanner, §VIII.5).
///
/// The increment of a step is about `z/u` units in the last place, and changes by a part `z` from step
/// to step: below `z = √u` its rounding is much the same for `u/z²` steps, whose errors add up like
/// their number.
pub(super) fn accumulated(z: f64, n: f64) -> f64 {
    let alike = (f64::UNIT_ROUNDOFF / (z * z)).max(1.0).min(n);
    (n * alike).sqrt()
}

/// The relative error that rounding may leave in an energy after `steps` steps of `dt`.
///
/// Most roundings of a step add up as in [`accumulated`], with a coefficient that was measured between
/// 0.5 and 3.4, up to 8 for the compositions; 12 cover the largest of a million values too. Some are
/// the same at every step and add up like n:
///
/// * where a step is no product of shears, the products in it are not one coefficient in rounded
///   arithmetic, and its determinant is off by up to `u·z²` (measured: 0.6 of that);
/// * a product of shears keeps areas whatever its coefficients are; but where `ω²Δt` has few bits
///   (0.1 · 10), the additions round in a pattern. Over 150 settings with round decimals the bias was
///   at most `0.07·u·z`; a tenth covers it.
///
/// Both are multiplied by `e^z`, the terms of a step that cancel at large `z = ωΔt` (of a
/// composition, with the sum of the sizes of its substeps for z), and by [`condition`].
pub(super) fn rounding_of_run(method: Method, omega: f64, dt: f64, steps: u64) -> f64 {
    let n = steps.max(1) as f64;
    let path = omega * dt * path_of_unit_step(method);
    let systematic = match method {
        Method::ExplicitEuler | Method::TextbookVerlet | Method::Rk4 => path * path,
        _ => 0.1 * path,
    };
    let roundings = (12.0 * accumulated(omega * dt, n) + systematic * n) * path.exp();
    f64::UNIT_ROUNDOFF * roundings * condition(method, omega * dt, steps)
}

/// The angle in rad, or the relative change of an eigenvalue, that rounding may leave after `steps`
/// steps: 8 roundings of `ωt` for the coefficients, which are rounded alike at every step, beside
/// what [`rounding_of_run`] leaves in any direction.
pub(super) fn slip_of_run(method: Method, omega: f64, dt: f64, steps: u64) -> f64 {
    let angle = omega * dt * steps as f64;
    rounding_of_run(method, omega, dt, steps)
        + 8.0 * f64::UNIT_ROUNDOFF * angle * condition(method, omega * dt, steps)
}

/// How much a perturbation of one step is magnified by those after it, relative to the orbit.
///
/// That is the condition of the eigenvectors in the norm of the energy. With the Schur form
/// `[λ₁ Δ; 0 λ₂]` and the gap `g = |λ₁ − λ₂|` it is `(Δ + √(Δ² + g²))/g`; for velocity Verlet
/// `1/√(1 − z²/4)`, the ratio of the axes of the ellipse on which orbits lie. Where the eigenvectors
/// meet, powers grow like `1 + nΔ`, and so does what they make of a perturbation.
pub(super) fn condition(method: Method, z: f64, steps: u64) -> f64 {
    let anywhere = State { q: [1.0], v: [0.0] };
    let unit = Oscillator { omega2: 1.0 };
    let step = UpdateMatrix::of_step(method, unit, &anywhere, z);
    let (departure, gap) = schur(&step);
    if departure == 0.0 {
        return 1.0;
    }
    let eigenvectors = (departure + departure.hypot(gap)) / gap;
    eigenvectors.min(1.0 + steps as f64 * departure)
}

/// `Δ` and `g` of a real `2 × 2` matrix.
fn schur(matrix: &UpdateMatrix<Wide>) -> (f64, f64) {
    let entry = |i: usize, j: usize| matrix.entry(i, j);
    let (skew, twist) = (entry(0, 0) - entry(1, 1), entry(0, 1) + entry(1, 0));
    let (difference, product) = (entry(0, 1) - entry(1, 0), entry(0, 1) * entry(1, 0));
    // (λ₁ − λ₂)² = (a − d)² + 4bc; ‖M‖² − |λ₁|² − |λ₂|² in the two cases.
    let discriminant = skew * skew + product.scaled(2);
    let departure = match discriminant.is_negative() {
        true => (skew * skew + twist * twist).sqrt().to_f64(),
        false => difference.to_f64().abs(),
    };
    (departure, discriminant.abs().sqrt().to_f64())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_condition_is_the_ratio_of_the_axes_and_linear_where_eigenvectors_meet() {
        for z in [0.1, 1.0, 1.9] {
            let found = condition(Method::VelocityVerlet, z, 1_000_000);
            let axes = 1.0 / (1.0 - z * z / 4.0_f64).sqrt();
            assert!((found / axes - 1.0).abs() < 1e-13, "{z}: {found} {axes}");
        }
        // RK4 and explicit Euler turn circles into circles.
        assert_eq!(condition(Method::Rk4, 0.7, 1000), 1.0);
        // At z = 2 the matrix of symplectic Euler is −1 but for an entry of 4 in the Schur form.
        assert_eq!(condition(Method::SymplecticEuler, 2.0, 1000), 4001.0);
    }

    #[test]
    fn roundings_of_steps_that_hardly_differ_add_up_like_their_number() {
        assert_eq!(accumulated(0.1, 1e6), 1e3);
        assert_eq!(accumulated(1e-16, 1e6), 1e6);
    }
}
