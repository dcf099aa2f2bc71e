//! One step of an implicit method on a linear system as a matrix of exact quotients of polynomials.

use libration_core::integrator::ImplicitIntegrator;
use libration_core::number::{Dual, Poly, RationalFunction};
use libration_core::system::{DampedOscillator, Differentiated, ImplicitSystem, StageCoefficients};
use libration_core::{Scalar, State, System};

use super::{StabilityWindow, UpdateMatrix, cramers_rule, stability_window};

/// Quotients of polynomials in the unknown `z = ωΔt`. Eight coefficients hold the products of a step that solves the equations of one
/// degree of freedom twice.
pub type UnknownImplicitStep = RationalFunction<8>;

/// The update matrix of an implicit method on a linear system, exact in the time step.
///
/// As a [`SymbolicStep`](super::SymbolicStep), in quotients of polynomials: [`RationalStep::new`] takes the oscillator with `ω = 1`.
#[derive(Clone, Copy, Debug)]
pub struct RationalStep {
    /// The update matrix.
    pub matrix: UpdateMatrix<UnknownImplicitStep>,
}

impl RationalStep {
    /// One step of `integrator` on the oscillator with `ω = 1`; none if the quotients outgrow their exact arithmetic.
    pub fn new(integrator: impl ImplicitIntegrator) -> Option<Self> {
        RationalStep::damped(integrator, 1.0, 0.0)
    }

    /// One step on `q̈ = −ω²q − γv`, in powers of `Δt`; none if the quotients outgrow their exact arithmetic.
    pub fn damped(integrator: impl ImplicitIntegrator, omega2: f64, gamma: f64) -> Option<Self> {
        let number = Dual::<UnknownImplicitStep>::from_f64;
        let system = DampedOscillator { omega2: number(omega2), gamma: number(gamma) };
        let system = ExactOscillator(Differentiated(system));
        let dt = UnknownImplicitStep::unknown();
        let matrix = UpdateMatrix::from_map(|e| integrator.step(&system, e, dt));
        let matrix = matrix.map(UnknownImplicitStep::in_lowest_terms);
        let valid = matrix.rows().iter().flatten().all(UnknownImplicitStep::is_valid);
        let step = RationalStep { matrix };
        (valid && step.over_one_denominator().is_some()).then_some(step)
    }

    /// `λ₁ + λ₂`, in lowest terms.
    pub fn trace(&self) -> UnknownImplicitStep {
        self.matrix.trace().in_lowest_terms()
    }

    /// `λ₁ · λ₂`, in lowest terms.
    pub fn determinant(&self) -> UnknownImplicitStep {
        // Before common factors cancel, it has twice the degree of an entry.
        let with_room = |x: UnknownImplicitStep| -> RationalFunction<16> {
            RationalFunction::new(x.numerator().with_room(), x.denominator().with_room())
        };
        let found = self.matrix.map(with_room).determinant().in_lowest_terms();
        RationalFunction::new(found.numerator().with_room(), found.denominator().with_room())
    }

    /// Whether the determinant is one for every time step.
    pub fn is_symplectic(&self) -> bool {
        self.determinant() == UnknownImplicitStep::one()
    }

    /// All windows of stability among the positive time steps, rising; none if no step is stable. They are isolated exactly, as those of
    /// a [`SymbolicStep`](super::SymbolicStep::stability_windows).
    pub fn stability_windows(&self) -> Vec<StabilityWindow> {
        match self.over_one_denominator() {
            Some((numerators, denominator)) => {
                stability_window::windows(numerators.each_ref(), &denominator)
            }
            None => Vec::new(),
        }
    }

    /// The numerators of the entries, row by row, over one denominator; none if they do not fit.
    fn over_one_denominator(&self) -> Option<([Poly<8>; 4], Poly<8>)> {
        let entries = [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(i, j)| self.matrix.entry(i, j));
        let mut common = Poly::one();
        for entry in &entries {
            let own = entry.denominator();
            if common.divided_exactly_by(own).is_none() {
                let is_multiple = own.divided_exactly_by(&common).is_some();
                common = if is_multiple { *own } else { common * *own };
            }
        }
        let mut numerators = [Poly::ZERO; 4];
        for (numerator, entry) in numerators.iter_mut().zip(&entries) {
            let factor = common.divided_exactly_by(entry.denominator())?;
            *numerator = (*entry.numerator() * factor).checked()?;
        }
        Some((numerators, common))
    }
}

/// The damped oscillator on quotients of polynomials.
struct ExactOscillator(Differentiated<DampedOscillator<Dual<UnknownImplicitStep>>>);

type Quotients = State<UnknownImplicitStep, 1>;
type Accelerations = [UnknownImplicitStep; 1];

impl System<UnknownImplicitStep, 1> for ExactOscillator {
    fn acceleration(&self, state: &Quotients) -> Accelerations {
        self.0.acceleration(state)
    }
}

impl ImplicitSystem<UnknownImplicitStep, 1> for ExactOscillator {
    const IS_EXACTLY_LINEAR: bool = true;

    fn acceleration_derivative(&self, at: &Quotients, direction: &Quotients) -> Accelerations {
        self.0.acceleration_derivative(at, direction)
    }

    fn solve_damping(
        &self,
        at: &Quotients,
        h: UnknownImplicitStep,
        right: Accelerations,
    ) -> Accelerations {
        self.0.solve_damping(at, h, right)
    }

    fn solve_damping_and_stiffness(
        &self,
        at: &Quotients,
        h: UnknownImplicitStep,
        right: Accelerations,
    ) -> Accelerations {
        self.0.solve_damping_and_stiffness(at, h, right)
    }

    fn solve_stage_accelerations<const N: usize>(
        &self,
        at: &[Quotients; N],
        of: StageCoefficients<'_, UnknownImplicitStep, N>,
        right: [Accelerations; N],
    ) -> [Accelerations; N] {
        let [zero, one] = [UnknownImplicitStep::zero(), UnknownImplicitStep::one()];
        let mut matrix = [[zero; N]; N];
        for (i, row) in matrix.iter_mut().enumerate() {
            let derivative = |q, v| self.acceleration_derivative(&at[i], &State { q: [q], v: [v] });
            let ([by_q], [by_v]) = (derivative(one, zero), derivative(zero, one));
            for (k, entry) in row.iter_mut().enumerate() {
                let unit = if i == k { one } else { zero };
                *entry = unit - (of.of_q[i][k] * by_q + of.of_v[i][k] * by_v);
            }
        }
        cramers_rule::solve(&matrix, &right.map(|[x]| x)).map(|x| [x])
    }
}

#[cfg(test)]
mod tests {
    use libration_core::{AnyMethod, ImplicitMethod};

    use super::*;
    use crate::SymbolicStep;

    fn shown(method: ImplicitMethod) -> [String; 4] {
        let step = RationalStep::new(method).unwrap();
        [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(i, j)| step.matrix.entry(i, j).to_string())
    }

    #[test]
    fn update_matrices_and_determinants_of_the_oscillator_are_those_of_the_textbooks() {
        let cayley =
            ["(1 − z²/4)/(1 + z²/4)", "z/(1 + z²/4)", "−z/(1 + z²/4)", "(1 − z²/4)/(1 + z²/4)"];
        // The real and the imaginary part of N²/|N|², where N = 1 + iz/2 − z²/12 and 1 + iz/2 − z²/10 − iz³/120.
        let (real, imaginary) = ("(1 − 5z²/12 + z⁴/144)", "(z − z³/12)");
        let denominator = "(1 + z²/12 + z⁴/144)";
        let entries = |real: &str, imaginary: &str, opposite: &str, denominator: &str| {
            [real, imaginary, opposite, real].map(|numerator| format!("{numerator}/{denominator}"))
        };
        let gauss_legendre_4 = entries(real, imaginary, "(−z + z³/12)", denominator);
        let (real, imaginary) = ("(1 − 9z²/20 + 11z⁴/600 − z⁶/14400)", "(z − 7z³/60 + z⁵/600)");
        let denominator = "(1 + z²/20 + z⁴/600 + z⁶/14400)";
        let gauss_legendre_6 = entries(real, imaginary, "(−z + 7z³/60 − z⁵/600)", denominator);
        let backward = ["1/(1 + z²)", "z/(1 + z²)", "−z/(1 + z²)", "1/(1 + z²)"];
        let owned = |texts: [&str; 4]| texts.map(str::to_owned);
        for method in ImplicitMethod::ALL {
            let (matrix, determinant) = match method {
                // Without damping it is symplectic Euler.
                ImplicitMethod::DampingImplicit => (owned(["1 − z²", "z", "−z", "1"]), "1"),
                ImplicitMethod::StablePd => (owned(["1 − z²", "z − z³", "−z", "1 − z²"]), "1 − z²"),
                ImplicitMethod::DampingStiffnessImplicit | ImplicitMethod::BackwardEuler => {
                    (owned(backward), "1/(1 + z²)")
                }
                ImplicitMethod::ImplicitMidpoint | ImplicitMethod::Trapezoid => {
                    (owned(cayley), "1")
                }
                ImplicitMethod::GaussLegendre4 => (gauss_legendre_4.clone(), "1"),
                ImplicitMethod::GaussLegendre6 => (gauss_legendre_6.clone(), "1"),
            };
            assert_eq!(shown(method), matrix, "{method:?}");
            let step = RationalStep::new(method).unwrap();
            assert_eq!(step.determinant().to_string(), determinant, "{method:?}");
            assert_eq!(step.is_symplectic(), determinant == "1");
        }
    }

    /// The end of the only window, which begins at 0.
    fn limit(method: ImplicitMethod, omega2: f64, gamma: f64) -> f64 {
        let windows = RationalStep::damped(method, omega2, gamma).unwrap().stability_windows();
        let [window] = windows[..] else { panic!("{method:?} {windows:?}") };
        assert_eq!(window.from.to_f64(), 0.0);
        window.to.map_or(f64::INFINITY, |to| to.to_f64())
    }

    #[test]
    fn limits_of_the_damped_oscillator_are_those_derived_by_hand() {
        for omega in [1.0, 3.7, 3.141e-4, 1e5 / 7.0] {
            for zeta in [0.0, 0.1, 1.0, 20.0_f64] {
                let (omega2, gamma) = (omega * omega, 2.0 * zeta * omega);
                for method in ImplicitMethod::ALL {
                    let z = match method {
                        ImplicitMethod::DampingImplicit => {
                            2.0 * (zeta + (1.0 + zeta * zeta).sqrt())
                        }
                        ImplicitMethod::StablePd => 2.0 / 3.0 * (zeta + (3.0 + zeta * zeta).sqrt()),
                        _ => f64::INFINITY,
                    };
                    let found = limit(method, omega2, gamma);
                    // The parameters are rounded.
                    let is_near = found == z || (found * omega / z - 1.0).abs() < 2e-14;
                    assert!(is_near, "{method:?} {zeta}: {found} {z}");
                }
            }
        }
    }

    #[test]
    fn a_growing_mode_of_small_steps_is_damped_by_backward_euler_in_large_ones() {
        // |1 − hλ|² = 1 − 0.2h + h² with λ = 0.1 ± i√0.99.
        let step = RationalStep::damped(ImplicitMethod::BackwardEuler, 1.0, -0.2).unwrap();
        let windows = step.stability_windows();
        let [window] = windows[..] else { panic!("{windows:?}") };
        assert!((window.from.to_f64() - 0.2).abs() < 1e-15 && window.to.is_none(), "{window:?}");
    }

    #[test]
    fn explicit_methods_have_the_same_windows_as_by_polynomials() {
        for method in libration_core::Method::ALL {
            let Some(rational) = RationalStep::new(AnyMethod::from(method)) else { continue };
            let ends = |windows: Vec<StabilityWindow>| -> Vec<[Option<f64>; 2]> {
                windows
                    .iter()
                    .map(|w| [Some(w.from.to_f64()), w.to.map(|to| to.to_f64())])
                    .collect()
            };
            let polynomials = SymbolicStep::new(method).unwrap();
            assert_eq!(ends(rational.stability_windows()), ends(polynomials.stability_windows()));
        }
    }
}
