//! The stability function of a step: what it makes of `ẏ = λy`.

use core::fmt;

use libration_core::integrator::ImplicitIntegrator;
use libration_core::number::RationalFunction;
use libration_core::system::{ImplicitSystem, StageCoefficients};
use libration_core::{AnyMethod, Elementary, Integrator, Scalar, State, System};
use libration_linear::{Matrix, eigenvalues};
use num_complex::Complex64;

use super::{StepWindow, UnknownImplicitStep, UnknownStep, cramers_rule};

/// The stability function `R(hλ)` of a step that uses nothing but rates: one step of `h` seconds on `ẏ = λy` multiplies `y` by it.
///
/// It is the result of the step itself, run on polynomials, or on quotients of polynomials if the step solves equations (E. Hairer, G. Wanner: Solving Ordinary Differential Equations II, 2nd ed.,
/// §IV.2).
#[derive(Clone, Copy, Debug)]
pub struct StabilityFunction {
    quotient: RationalFunction<32>,
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

/// The same on quotients.
struct ImplicitTestEquation;

type Quotients = State<UnknownImplicitStep, 1>;

impl System<UnknownImplicitStep, 1> for ImplicitTestEquation {
    fn acceleration(&self, _: &Quotients) -> [UnknownImplicitStep; 1] {
        [UnknownImplicitStep::UNDEFINED]
    }

    fn rate(&self, state: Quotients) -> Quotients {
        State { q: state.q, v: [UnknownImplicitStep::zero()] }
    }
}

impl ImplicitSystem<UnknownImplicitStep, 1> for ImplicitTestEquation {
    const IS_EXACTLY_LINEAR: bool = true;

    fn acceleration_derivative(&self, _: &Quotients, _: &Quotients) -> [UnknownImplicitStep; 1] {
        [UnknownImplicitStep::UNDEFINED]
    }

    fn solve_damping(
        &self,
        _: &Quotients,
        _: UnknownImplicitStep,
        _: [UnknownImplicitStep; 1],
    ) -> [UnknownImplicitStep; 1] {
        [UnknownImplicitStep::UNDEFINED]
    }

    fn solve_damping_and_stiffness(
        &self,
        _: &Quotients,
        _: UnknownImplicitStep,
        _: [UnknownImplicitStep; 1],
    ) -> [UnknownImplicitStep; 1] {
        [UnknownImplicitStep::UNDEFINED]
    }

    fn solve_rate(&self, _: &Quotients, h: UnknownImplicitStep, right: Quotients) -> Quotients {
        let one = UnknownImplicitStep::one();
        State { q: [right.q[0].quotient(one - h)], v: right.v }
    }

    fn solve_stage_accelerations<const N: usize>(
        &self,
        _: &[Quotients; N],
        _: StageCoefficients<'_, UnknownImplicitStep, N>,
        _: [[UnknownImplicitStep; 1]; N],
    ) -> [[UnknownImplicitStep; 1]; N] {
        [[UnknownImplicitStep::UNDEFINED]; N]
    }

    fn solve_stages<const N: usize>(
        &self,
        _: &[Quotients; N],
        h: &[[UnknownImplicitStep; N]; N],
        mut right: [Quotients; N],
    ) -> [Quotients; N] {
        let mut matrix = h.map(|row| row.map(|h| -h));
        (0..N).for_each(|i| matrix[i][i] = matrix[i][i] + UnknownImplicitStep::one());
        let solution = cramers_rule::solve(&matrix, &right.map(|stage| stage.q[0]));
        right.iter_mut().zip(solution).for_each(|(stage, y)| stage.q = [y]);
        right
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
        (polynomial.is_valid() && unused.is_valid())
            .then(|| StabilityFunction { quotient: RationalFunction::from(polynomial) })
    }

    /// That of an integrator that solves equations; none if its step distinguishes positions from velocities.
    pub fn implicit(integrator: impl ImplicitIntegrator) -> Option<Self> {
        let start = State { q: [UnknownImplicitStep::one()], v: [UnknownImplicitStep::zero()] };
        let end = integrator.step(&ImplicitTestEquation, start, UnknownImplicitStep::unknown());
        let quotient = end.q[0].in_lowest_terms();
        let quotient = RationalFunction::new(
            quotient.numerator().with_room(),
            quotient.denominator().with_room(),
        );
        (quotient.is_valid() && end.v[0].is_valid()).then_some(StabilityFunction { quotient })
    }

    /// That of a built-in integrator; none if its step distinguishes positions from velocities.
    pub fn of(method: impl Into<AnyMethod>) -> Option<Self> {
        match method.into() {
            AnyMethod::Explicit(method) => StabilityFunction::new(method),
            AnyMethod::Implicit(method) => StabilityFunction::implicit(method),
        }
    }

    /// `R(z)`, by Horner's rule.
    pub fn at(&self, z: Complex64) -> Complex64 {
        let value = |p: &UnknownStep| {
            coefficients(p).into_iter().rev().fold(Complex64::ZERO, |sum, c| sum * z + c)
        };
        value(self.quotient.numerator()) / value(self.quotient.denominator())
    }

    /// The time steps `h` in s with `|R(hλ)| ≤ 1`, for an eigenvalue `λ` in 1/s.
    ///
    /// They lie between the roots of the polynomial `|N(hλ)|² − |D(hλ)|²` in `h`, where `R = N/D`.
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

    /// The coefficients of `|N(hu)|² − |D(hu)|²` for a number `u` of size 1; those that are rounding are zero.
    fn excess(&self, unit: Complex64) -> Vec<f64> {
        let [numerator, denominator] =
            [self.quotient.numerator(), self.quotient.denominator()].map(coefficients);
        let length = 2 * numerator.len().max(denominator.len()) - 1;
        let (mut sums, mut sizes) = (vec![0.0; length], vec![0.0; length]);
        for (polynomial, sign) in [(numerator, 1.0), (denominator, -1.0)] {
            for (j, a) in polynomial.iter().enumerate() {
                for (k, b) in polynomial.iter().enumerate() {
                    let turned = unit.powi(j as i32) * unit.conj().powi(k as i32);
                    sums[j + k] += sign * a * b * turned.re;
                    sizes[j + k] += (a * b).abs();
                }
            }
        }
        let known = |(sum, size): (f64, f64)| if sum.abs() > ROUNDING * size { sum } else { 0.0 };
        sums.into_iter().zip(sizes).map(known).collect()
    }
}

/// The coefficients of a polynomial, that of `z⁰` first.
fn coefficients(polynomial: &UnknownStep) -> Vec<f64> {
    let degree = polynomial.degree().unwrap_or(0);
    (0..=degree).map(|k| polynomial.coefficient(k).to_f64()).collect()
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

/// As a polynomial in `z`, or a quotient of two.
impl fmt::Display for StabilityFunction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.quotient.fmt(f)
    }
}

#[cfg(test)]
mod tests {
    use libration_core::{ImplicitMethod, Method};

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

    #[test]
    fn implicit_runge_kutta_methods_have_the_quotients_of_the_textbook_and_no_limit_on_decaying_modes()
     {
        for method in ImplicitMethod::ALL {
            let text = StabilityFunction::of(method).map(|function| function.to_string());
            let wanted = match method {
                ImplicitMethod::DampingStiffnessImplicit | ImplicitMethod::BackwardEuler => {
                    Some("1/(1 − z)")
                }
                ImplicitMethod::ImplicitMidpoint | ImplicitMethod::Trapezoid => {
                    Some("(1 + z/2)/(1 − z/2)")
                }
                ImplicitMethod::GaussLegendre4 => Some("(1 + z/2 + z²/12)/(1 − z/2 + z²/12)"),
                ImplicitMethod::GaussLegendre6 => {
                    Some("(1 + z/2 + z²/10 + z³/120)/(1 − z/2 + z²/10 − z³/120)")
                }
                ImplicitMethod::DampingImplicit | ImplicitMethod::StablePd => None,
            };
            assert_eq!(text.as_deref(), wanted, "{}", method.name());
            let Some(function) = StabilityFunction::of(method) else { continue };
            for value in [[-3.0, 0.0], [-1.0, 20.0], [0.0, 5.0], [0.0, 0.0]] {
                let stable = function.stable_steps(Complex64::new(value[0], value[1]));
                assert_eq!(stable, [StepWindow::ALL], "{method:?} {value:?}");
            }
            // 1/(1 − 0.5 i), and (1 + 0.25 i)/(1 − 0.25 i) of size 1.
            let found = function.at(Complex64::new(0.0, 0.5)).norm();
            let wanted = if method.order() == 1 { 0.8_f64.sqrt() } else { 1.0 };
            assert!((found - wanted).abs() < 1e-15, "{method:?} {found}");
        }
        // |1 − hλ| ≥ 1 from h = 2 Re λ/|λ|² on.
        let euler = StabilityFunction::of(ImplicitMethod::BackwardEuler).unwrap();
        let [window] = euler.stable_steps(Complex64::new(1.0, 3.0))[..] else { panic!() };
        assert!((window.from - 0.2).abs() < 1e-15 && window.to.is_infinite(), "{window:?}");
    }
}
