//! Stable time steps by search.

use libration_core::AnyMethod;
use libration_linear::eigenvalues;
use num_complex::Complex64;

use super::{LinearStepper, StepWindow};

/// Growth per step that counts as none: of multipliers near 1 with modes at rest, since rounding parts a double eigenvalue 1 by its root,
/// and of all others.
const NEUTRAL: [f64; 2] = [1e-7, 1e-11];

/// Distance from 1 of a multiplier that may be that of a mode at rest.
const AT_REST: f64 = 1e-6;

/// Relative width below which a window of a search is a point at which eigenvalues touch the unit circle.
const POINT: f64 = 1e-6;

/// The range of a search where damping is implicit, times the size of the fastest mode: damping lengthens stable steps.
pub(crate) const DAMPED: [f64; 2] = [0.1, 1e3];

/// Where the spectral radius is at most 1, up to a step in which the fastest mode has `|hλ| = most`; where it still is there, up to twice
/// that under an explicit method, and none under an implicit one. Steps are evenly spaced, or from `first` on by equal factors.
pub(crate) fn searched_windows(
    stepper: &LinearStepper,
    method: AnyMethod,
    values: &[Complex64],
    [first, most]: [f64; 2],
) -> Option<Vec<StepWindow>> {
    let fastest = values.iter().map(|value| value.norm()).fold(0.0, f64::max);
    if fastest == 0.0 || !most.is_finite() {
        return Some(vec![StepWindow::ALL]);
    }
    let has_rest = values.contains(&Complex64::ZERO);
    let neutral = |x: &Complex64| match has_rest && (x - 1.0).norm() <= AT_REST {
        true => NEUTRAL[0],
        false => NEUTRAL[1],
    };
    let is_stable = |z: f64| {
        let step = stepper.with_step::<f64>(method, z / fastest);
        let values = step.and_then(|step| eigenvalues(&step.update_matrix()));
        values.is_some_and(|values| values.iter().all(|x| x.norm() <= 1.0 + neutral(x)))
    };
    // Eigenvalues cost the cube of the size.
    let points = (400_000 / values.len().pow(2)).clamp(50, 400);
    let place = |k: usize| match k as f64 / points as f64 {
        part if first > 0.0 => most * (first / most).powf(1.0 - part),
        part => most * part,
    };
    let states: Vec<bool> = (1..=points).map(|k| is_stable(place(k))).collect();
    if states[points - 1] {
        return match method {
            // The step is a polynomial, which is large in the end: the stable steps go on beyond the range.
            AnyMethod::Explicit(_) => {
                searched_windows(stepper, method, values, [first, 2.0 * most])
            }
            AnyMethod::Implicit(_) => None,
        };
    }
    let mut cuts = Vec::new();
    for k in 1..points {
        if states[k - 1] != states[k] {
            cuts.push(bisected(place(k), place(k + 1), |z| is_stable(z) == states[k - 1]));
        }
    }
    if !states[0] {
        cuts.insert(0, bisected(0.0, place(1), is_stable));
    }
    let windows = StepWindow::of_cells(&cuts, |z| z <= most && is_stable(z));
    let wide = windows.into_iter().filter(|window| window.to - window.from > POINT * window.to);
    Some(wide.map(|window| window.scaled(fastest.recip())).collect())
}

/// The end of `holds` between a point where it holds and one where it does not.
fn bisected(mut inside: f64, mut outside: f64, holds: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..40 {
        let middle = 0.5 * (inside + outside);
        if holds(middle) { inside = middle } else { outside = middle }
    }
    inside
}

#[cfg(test)]
mod tests {
    use libration_core::{ImplicitMethod, Method};
    use libration_linear::Matrix;

    use super::*;

    fn oscillator(omega2: f64, gamma: f64) -> Matrix {
        Matrix::from_rows(&[[0.0, 1.0], [-omega2, -gamma]]).unwrap()
    }

    #[test]
    fn searched_windows_of_a_damped_oscillator_are_those_of_its_exact_polynomials() {
        for (omega2, gamma) in [(9.0, 0.6), (9.0, 6.0), (9.0, 30.0)] {
            let a = oscillator(omega2, gamma);
            let stepper = LinearStepper::new(&a).unwrap();
            for method in [Method::SymplecticEuler, Method::VelocityVerlet, Method::TextbookVerlet]
            {
                let exact = stepper.stable_steps(method, &eigenvalues(&a).unwrap()).unwrap();
                let values = eigenvalues(&a).unwrap();
                let found = searched_windows(&stepper, method.into(), &values, [0.0, 5.0]).unwrap();
                // A narrow window of overdamped Verlet steps is beyond the search.
                assert!(exact.len() >= found.len(), "{method:?} {found:?} {exact:?}");
                for (found, exact) in found.iter().zip(&exact) {
                    // A growth of 10⁻¹¹ counts as none; eigenvalues leave the circle at a rate of about one per ωh.
                    assert!((found.from - exact.from).abs() < 1e-10, "{method:?} {found:?}");
                    assert!((found.to - exact.to).abs() < 1e-10, "{method:?} {found:?} {exact:?}");
                }
            }
        }
    }

    #[test]
    fn a_search_whose_range_ends_in_stable_steps_goes_on_to_their_end() {
        let a = oscillator(0.0945, 0.046);
        let stepper = LinearStepper::new(&a).unwrap();
        let values = eigenvalues(&a).unwrap();
        let method = Method::from_name("dormand-prince-rkn-6").unwrap();
        let exact = stepper.stable_steps(method, &values).unwrap();
        let found = searched_windows(&stepper, method.into(), &values, [0.0, 1.0]).unwrap();
        let [[found], [exact]] = [&found[..], &exact[..]] else { panic!("{found:?} {exact:?}") };
        // As above; without damping no step is stable, so that the range has no other end.
        assert!((found.to / exact.to - 1.0).abs() < 1e-10 && found.from == 0.0, "{found:?}");
    }

    #[test]
    fn searched_windows_under_implicit_damping_are_those_of_the_damped_oscillator_by_hand() {
        for zeta in [0.1_f64, 1.0, 5.0] {
            let a = oscillator(9.0, 6.0 * zeta);
            let stepper = LinearStepper::new(&a).unwrap();
            let values = eigenvalues(&a).unwrap();
            let method = AnyMethod::from(ImplicitMethod::DampingImplicit);
            let [found] = searched_windows(&stepper, method, &values, DAMPED).unwrap()[..] else {
                panic!()
            };
            let limit = 2.0 * (zeta + (1.0 + zeta * zeta).sqrt()) / 3.0;
            assert!((found.to / limit - 1.0).abs() < 1e-6, "{found:?} {limit}");
        }
    }

    #[test]
    fn a_mode_at_rest_hides_no_slow_growth_of_another() {
        // Springs and damping of two joints leave a third, free mass at rest.
        let a = |gamma: f64| {
            Matrix::from_fn(6, 6, |i, j| match (i, j) {
                (0..3, _) => f64::from(u8::from(j == i + 3)),
                (3, 0) | (4, 1) => -1.0,
                (3, 3) => -gamma,
                (4, 4) => -0.1,
                (3, 4) | (4, 3) => 1e-3,
                _ => 0.0,
            })
        };
        // A multiplier is −1 at h² + 2 γ h = 4 but for the coupling, whose square is 10⁻⁶.
        let (gamma, matrix) = (3.0, a(3.0));
        let stepper = LinearStepper::new(&matrix).unwrap();
        let values = eigenvalues(&matrix).unwrap();
        let method = AnyMethod::from(Method::SymplecticEuler);
        let found = searched_windows(&stepper, method, &values, [0.0, 5.0]).unwrap();
        let limit = (gamma * gamma + 4.0_f64).sqrt() - gamma;
        let last = found.last().unwrap();
        assert!((last.to / limit - 1.0).abs() < 1e-5, "{found:?} {limit}");
        let at = |part: f64| {
            let step = stepper.with_step::<f64>(method, last.to * part).unwrap().update_matrix();
            let far =
                eigenvalues(&step).unwrap().into_iter().filter(|x| (x - 1.0).norm() > AT_REST);
            far.map(|x| x.norm()).fold(0.0, f64::max) - 1.0
        };
        assert!(at(1.0) <= NEUTRAL[1] && at(1.0 + 1e-9) > NEUTRAL[1], "{}", at(1.0));
    }

    #[test]
    fn a_search_that_ends_among_stable_steps_says_so() {
        // The limit of ζ = 300 is at 2ζ + 2√(1 + ζ²) = 1200 times the time 1/ω, in which the fastest mode has 600.
        let a = oscillator(1.0, 600.0);
        let stepper = LinearStepper::new(&a).unwrap();
        let values = eigenvalues(&a).unwrap();
        let method = AnyMethod::from(ImplicitMethod::DampingImplicit);
        assert_eq!(searched_windows(&stepper, method, &values, DAMPED), None);
    }
}
