//! The stability function of a step: what it makes of `ẏ = λy`.

use core::fmt;

use libration_core::{Integrator, Scalar, State, System};
use libration_linear::{Matrix, eigenvalues};
use num_complex::Complex64;

use super::{StepWindow, UnknownStep};

/// The stability function `R(hλ)` of a step that uses nothing but rates: one step of `h` seconds on `ẏ = λy` multiplies `y` by it.
///
/// It is the result of the step itself, run on polynomials (E. Hairer, G. Wanner: Solving Ordinary Differential Equations II, 2nd ed.,
/// §IV.2).
#[derive(Clone, Copy, Debug)]
pub struct StabilityFunction {
    polynomial: UnknownStep,
}

/// `ẏ = y`, with `y` as a position. It has no acceleration: a step that asks for one has no stability function.
struct TestEquation;

impl System<UnknownStep, 1> for TestEquation {
    fn acceleration(&self, _: &State<UnknownStep, 1>) -> [UnknownStep; 1] {
        [UnknownStep::UNDEFINED]
    }

    fn rate(&self, state: State<UnknownStep, 1>) -> State<UnknownStep, 1> {
        State { q: state.q, v: [UnknownStep::zero()] }
    }
}

/// Part of the sizes of its terms below which a coefficient is rounding.
const ROUNDING: f64 = 1e-14;

impl StabilityFunction {
    /// That of `integrator`; none if its step distinguishes positions from velocities.
    pub fn new(integrator: impl Integrator) -> Option<Self> {
        let start = State { q: [UnknownStep::one()], v: [UnknownStep::zero()] };
        let State { q: [polynomial], v: [unused] } =
            integrator.step(&TestEquation, start, UnknownStep::unknown());
        (polynomial.is_valid() && unused.is_valid()).then_some(StabilityFunction { polynomial })
    }

    fn coefficients(&self) -> Vec<f64> {
        let degree = self.polynomial.degree().unwrap_or(0);
        (0..=degree).map(|k| self.polynomial.coefficient(k).to_f64()).collect()
    }

    /// `R(z)`, by Horner's rule.
    pub fn at(&self, z: Complex64) -> Complex64 {
        self.coefficients().into_iter().rev().fold(Complex64::ZERO, |sum, c| sum * z + c)
    }

    /// The time steps `h` in s with `|R(hλ)| ≤ 1`, for an eigenvalue `λ` in 1/s.
    ///
    /// They lie between the roots of the polynomial `|R(hλ)|² − 1` in `h`.
    pub fn stable_steps(&self, value: Complex64) -> Vec<StepWindow> {
        let size = value.norm();
        if size == 0.0 {
            return vec![StepWindow::ALL];
        }
        let excess = self.excess(value / size);
        let Some(low) = excess.iter().position(|c| *c != 0.0) else {
            return vec![StepWindow::ALL];
        };
        let high = excess.iter().rposition(|c| *c != 0.0).unwrap_or(low);
        let polynomial = &excess[low..=high];
        let at = |h: f64| polynomial.iter().rev().fold(0.0, |sum, c| sum * h + c);
        let windows = StepWindow::of_cells(&positive_roots(polynomial), |h| at(h) <= 0.0);
        windows.into_iter().map(|window| window.scaled(size.recip())).collect()
    }

    /// The coefficients of `|R(hu)|² − 1` for a number `u` of size 1; those that are rounding are zero.
    fn excess(&self, unit: Complex64) -> Vec<f64> {
        let coefficients = self.coefficients();
        let degree = coefficients.len() - 1;
        let (mut sums, mut sizes) = (vec![0.0; 2 * degree + 1], vec![0.0; 2 * degree + 1]);
        for (j, a) in coefficients.iter().enumerate() {
            for (k, b) in coefficients.iter().enumerate() {
                let turned = unit.powi(j as i32) * unit.conj().powi(k as i32);
                sums[j + k] += a * b * turned.re;
                sizes[j + k] += (a * b).abs();
            }
        }
        sums[0] -= 1.0;
        let known = |(sum, size): (f64, f64)| if sum.abs() > ROUNDING * size { sum } else { 0.0 };
        sums.into_iter().zip(sizes).map(known).collect()
    }
}

/// The real roots above zero of a polynomial with these coefficients, rising; of the first and the last none is zero.
fn positive_roots(polynomial: &[f64]) -> Vec<f64> {
    let degree = polynomial.len() - 1;
    let companion = Matrix::from_fn(degree, degree, |i, j| match i {
        0 => -polynomial[degree - 1 - j] / polynomial[degree],
        i => f64::from(u8::from(i == j + 1)),
    });
    let values = eigenvalues(&companion).unwrap_or_default();
    let real = values.into_iter().filter(|root| root.im == 0.0 && root.re > 0.0);
    let mut roots: Vec<f64> = real.map(|root| root.re).collect();
    roots.sort_by(f64::total_cmp);
    roots
}

/// As a polynomial in `z`.
impl fmt::Display for StabilityFunction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.polynomial.fmt(f)
    }
}

#[cfg(test)]
mod tests {
    use libration_core::Method;

    use super::*;

    fn of(method: Method) -> StabilityFunction {
        StabilityFunction::new(method).unwrap()
    }

    #[test]
    fn only_runge_kutta_methods_have_a_stability_function_and_it_is_that_of_the_textbook() {
        for method in Method::ALL {
            let text = StabilityFunction::new(method).map(|function| function.to_string());
            let wanted = match method {
                Method::ExplicitEuler => Some("1 + z"),
                Method::Rk4 => Some("1 + z + z²/2 + z³/6 + z⁴/24"),
                _ => None,
            };
            assert_eq!(text.as_deref(), wanted, "{}", method.name());
        }
    }

    #[test]
    fn limits_of_real_and_imaginary_eigenvalues_are_those_of_the_textbook() {
        // Hairer and Wanner, table IV.2.1: −2.785 on the real axis; 2√2 on the imaginary one.
        let [window] = of(Method::Rk4).stable_steps(Complex64::from(-2.0))[..] else { panic!() };
        assert!(window.from == 0.0 && (window.to - 2.785_293_563_405_28 / 2.0).abs() < 1e-13);
        let [window] = of(Method::Rk4).stable_steps(Complex64::new(0.0, 4.0))[..] else { panic!() };
        assert!(window.from == 0.0 && (window.to - 0.5_f64.sqrt()).abs() < 1e-14, "{window:?}");
        // h < −2 Re λ/|λ|².
        let euler = of(Method::ExplicitEuler);
        let [window] = euler.stable_steps(Complex64::new(-1.0, 7.0))[..] else { panic!() };
        assert!(window.from == 0.0 && (window.to - 0.04).abs() < 1e-15, "{window:?}");
        assert_eq!(euler.stable_steps(Complex64::new(0.0, 7.0)), []);
        assert_eq!(euler.stable_steps(Complex64::ZERO), [StepWindow::ALL]);
        // A growing mode near the imaginary axis is damped by RK4 in a window that does not begin at 0.
        let [window] = of(Method::Rk4).stable_steps(Complex64::new(0.001, 1.0))[..] else {
            panic!()
        };
        assert!(window.from > 0.5 && window.to < 2.9, "{window:?}");
    }
}
