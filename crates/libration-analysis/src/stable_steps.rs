//! The time steps at which an integrator is stable on a linear plant.

use libration_core::AnyMethod;
use libration_core::system::DampedOscillator;
use libration_linear::eigenvalues;
use num_complex::Complex64;

use super::neutral_steps::MOST_EXACT;
use super::{LinearStepper, StepLimits, StepWindow};

/// Part of the largest eigenvalue that is a rounding of another one.
const ROUNDING: f64 = 1e-13;

/// The same of the growth rate of a mode that oscillates.
const NO_GROWTH: f64 = 1e-12;

/// Part of the largest eigenvalue up to which rounding parts several zeros: by the root of a rounding.
const PARTED: f64 = 1e-7;

/// Part of the size of parted zeros below which their sum is zero.
const NO_SUM: f64 = 1e-3;

/// Eigenvalues without their rounding: those beside the largest are zero, and so are growth rates of oscillations.
///
/// Rounding parts a double zero, such as that of a free mass, to small numbers whose sum is zero. So such small numbers are zero.
pub fn without_rounding(values: &[Complex64]) -> Vec<Complex64> {
    let largest = values.iter().map(|value| value.norm()).fold(0.0, f64::max);
    let small = values.iter().filter(|value| value.norm() <= PARTED * largest);
    let size = small.clone().map(|value| value.norm()).fold(0.0, f64::max);
    let sum: f64 = small.map(|value| value.re).sum();
    let zero = if sum.abs() <= NO_SUM * size { PARTED } else { ROUNDING };
    let known = |value: &Complex64| match value {
        value if value.norm() <= zero * largest => Complex64::ZERO,
        value if value.im != 0.0 && value.re.abs() <= NO_GROWTH * largest => {
            Complex64::new(0.0, value.im)
        }
        value => *value,
    };
    values.iter().map(known).collect()
}

impl LinearStepper {
    /// The time steps in s at which no mode grows that does not grow in exact steps, for the eigenvalues of the plant in 1/s.
    ///
    /// With a stability function they are exact, also if other modes of the plant grow. Of a mechanical plant without damping or with
    /// modal damping they are those of its oscillators, from exact polynomials. With other damping, and with modal damping under steps of
    /// more than 15 forces, the spectral radius of the update
    /// matrix is searched up to about twice the limit of the fastest mode without damping, at distances of about a hundredth of it:
    /// narrower windows and those beyond may be missed. Where damping is implicit it is searched from 0.1 to 1000 times the time of the fastest
    /// mode, at distances of a few per cent, and not known if it is stable there. Where a mode oscillates for ever under forces of
    /// velocities that are no modal damping, the search has 1024 bits, since growth may be small at each step.
    ///
    /// None for the [reason](LinearStepper::unknown_steps) that stable steps are not known.
    pub fn stable_steps(
        &self,
        method: impl Into<AnyMethod>,
        values: &[Complex64],
    ) -> Option<Vec<StepWindow>> {
        StepLimits::new(method).of(self, values)
    }

    /// The reason in words for which [`stable_steps`](LinearStepper::stable_steps) of an integrator that applies are not known.
    pub fn unknown_steps(
        &self,
        method: impl Into<AnyMethod>,
        values: &[Complex64],
    ) -> &'static str {
        let values = without_rounding(values);
        let is_neutral = values.iter().any(|value| value.re == 0.0 && value.im != 0.0);
        match method.into() {
            _ if values.iter().any(|value| value.re > 0.0) => "as a mode of the plant grows",
            _ if is_neutral && values.len() > MOST_EXACT => {
                "as the plant has too many states for exact arithmetic"
            }
            AnyMethod::Implicit(_) => "as the longest steps of the search are stable",
            AnyMethod::Explicit(_) => "as the polynomials of its steps outgrow exact arithmetic",
        }
    }

    /// The damped oscillators that a mechanical plant consists of; none if they are not known.
    ///
    /// Modes are oscillators if the matrices of damping and stiffness, both over the masses, commute (T. K. Caughey, M. E. J. O'Kelly,
    /// Journal of Applied Mechanics 32, 1965).
    pub(super) fn oscillators(&self, values: &[Complex64]) -> Option<Vec<DampedOscillator<f64>>> {
        let (stiffness, damping) = self.stiffness_and_damping();
        if stiffness.rows() == 1 {
            let [omega2, gamma] = [stiffness[(0, 0)], damping[(0, 0)]];
            return Some(vec![DampedOscillator { omega2, gamma }]);
        }
        let mut apart = &stiffness * &damping;
        apart.add_scaled(-1.0, &(&damping * &stiffness));
        let rounding = 1e-13 * stiffness.row_sum_norm() * damping.row_sum_norm();
        let oscillates = values.iter().all(|value| value.im != 0.0);
        // A gyroscopic force commutes with equal stiffnesses, too.
        let rates = eigenvalues(&damping)?;
        let is_damping = rates.iter().all(|rate| rate.im.abs() <= PARTED * damping.row_sum_norm());
        let upper = values.iter().filter(|value| value.im > 0.0);
        let one = |value: &Complex64| DampedOscillator {
            omega2: value.norm_sqr(),
            gamma: -2.0 * value.re,
        };
        (oscillates && is_damping && apart.largest() <= rounding).then(|| upper.map(one).collect())
    }
}

#[cfg(test)]
mod tests {
    use libration_core::{ImplicitMethod, Method};
    use libration_linear::Matrix;

    use super::*;

    fn windows(a: &Matrix, method: impl Into<AnyMethod>) -> Option<Vec<StepWindow>> {
        LinearStepper::new(a).unwrap().stable_steps(method, &eigenvalues(a).unwrap())
    }

    fn oscillator(omega2: f64, gamma: f64) -> Matrix {
        Matrix::from_rows(&[[0.0, 1.0], [-omega2, -gamma]]).unwrap()
    }

    #[test]
    fn roundings_of_zeros_are_zero_and_slow_modes_of_stiff_plants_stay() {
        let of = |values: &[f64]| {
            let values: Vec<Complex64> = values.iter().map(|&x| Complex64::from(x)).collect();
            without_rounding(&values).iter().map(|value| value.re).collect::<Vec<f64>>()
        };
        assert_eq!(of(&[3e-8, -3e-8, -4.0]), [0.0, 0.0, -4.0]);
        assert_eq!(of(&[2e-16, -1.0, -1e3]), [0.0, -1.0, -1e3]);
        assert_eq!(of(&[-1.0, -2.0, -1e10]), [-1.0, -2.0, -1e10]);
        let undamped = [Complex64::new(2e-16, 7.0), Complex64::new(-1e-9, 9.0)];
        assert_eq!(without_rounding(&undamped), [Complex64::new(0.0, 7.0), undamped[1]]);
    }

    #[test]
    fn modal_damping_has_the_windows_of_its_oscillators() {
        // Damping of 0.1 times the stiffness, whose squared frequencies are 1 and 3.
        let modal = Matrix::from_rows(&[
            [0.0, 0.0, 1.0, 0.0],
            [0.0, 0.0, 0.0, 1.0],
            [-2.0, 1.0, -0.2, 0.1],
            [1.0, -2.0, 0.1, -0.2],
        ])
        .unwrap();
        let one = windows(&oscillator(3.0, 0.3), Method::SymplecticEuler).unwrap();
        let both = windows(&modal, Method::SymplecticEuler).unwrap();
        assert_eq!(both.len(), 1);
        assert!((both[0].to / one[0].to - 1.0).abs() < 1e-13, "{both:?} {one:?}");
    }

    #[test]
    fn stable_steps_of_implicit_methods_are_those_of_the_damped_oscillator_by_hand() {
        for (omega, zeta) in [(3.0_f64, 0.1), (3.0, 1.0_f64), (3.0, 5.0)] {
            let a = oscillator(omega * omega, 2.0 * zeta * omega);
            let [window] = windows(&a, ImplicitMethod::DampingImplicit).unwrap()[..] else {
                panic!()
            };
            let limit = 2.0 * (zeta + (1.0 + zeta * zeta).sqrt()) / omega;
            assert!((window.to / limit - 1.0).abs() < 1e-13, "{window:?} {limit}");
            for method in [ImplicitMethod::BackwardEuler, ImplicitMethod::ImplicitMidpoint] {
                assert_eq!(windows(&a, method), Some(vec![StepWindow::ALL]));
            }
        }
    }

    #[test]
    fn gyroscopic_forces_are_no_damping() {
        // Charges in a magnetic field and a trap: eigenvalues ±0.0499i, ±20.05i in exact steps, and growth in each kick.
        let gyroscopic = |field: f64, other: f64| {
            Matrix::from_rows(&[
                [0.0, 0.0, 1.0, 0.0],
                [0.0, 0.0, 0.0, 1.0],
                [-1.0, 0.0, 0.0, field],
                [0.0, -other, -field, 0.0],
            ])
            .unwrap()
        };
        for (field, other) in [(10.0, 1.0), (0.1, 1.0), (10.0, 2.0)] {
            let a = gyroscopic(field, other);
            for method in [Method::SymplecticEuler, Method::VelocityVerlet] {
                // Never stable.
                assert_eq!(windows(&a, method), Some(vec![]), "{field} {other} {method:?}");
                let stepper = LinearStepper::new(&a).unwrap();
                let step = stepper.with_step::<f64>(method, 0.05).unwrap();
                let values = eigenvalues(&step.update_matrix()).unwrap();
                assert!(values.iter().any(|value| value.norm() > 1.0 + 1e-9));
            }
            assert!(windows(&a, Method::Rk4).is_some_and(|windows| windows[0].to > 0.0));
        }
    }

    #[test]
    fn growth_below_the_rounding_of_a_step_is_growth() {
        // A Foucault pendulum: ω² of 0.9 and twice a rotation of 5e-5. NumPy gives 5e-9 per step at ωh = 1, and rounding at 0.01.
        let turning = |rotation: f64| {
            let [plus, minus] = [2.0 * rotation, -2.0 * rotation];
            let rows = [
                [0.0, 0.0, 1.0, 0.0],
                [0.0, 0.0, 0.0, 1.0],
                [-0.9, 0.0, 0.0, plus],
                [0.0, -0.9, minus, 0.0],
            ];
            Matrix::from_rows(&rows).unwrap()
        };
        for rotation in [0.5, 5e-5, 1e-9] {
            let a = turning(rotation);
            for method in [Method::SymplecticEuler, Method::VelocityVerlet] {
                assert_eq!(windows(&a, method), Some(vec![]), "{rotation} {method:?}");
            }
            // The faster circle has a rate of Ω + √(ω² + Ω²), at most 1.58.
            assert!(windows(&a, Method::Rk4).is_some_and(|windows| windows[0].to > 1.79));
        }
    }

    #[test]
    fn the_fastest_mode_limits_the_step_and_modes_at_zero_do_not() {
        // Two masses of 1 kg, free, with a spring of 8 N/m between them: 0 and 4 rad/s.
        let free = Matrix::from_rows(&[
            [0.0, 0.0, 1.0, 0.0],
            [0.0, 0.0, 0.0, 1.0],
            [-8.0, 8.0, 0.0, 0.0],
            [8.0, -8.0, 0.0, 0.0],
        ])
        .unwrap();
        for (method, limit) in [(Method::VelocityVerlet, 0.5), (Method::Rk4, 0.5_f64.sqrt())] {
            let [window] = windows(&free, method).unwrap()[..] else { panic!("{method:?}") };
            assert!(window.from == 0.0 && (window.to / limit - 1.0).abs() < 1e-12, "{window:?}");
        }
        assert_eq!(windows(&free, Method::ExplicitEuler), Some(vec![]));
        // It does not apply to matrices whose rows are no velocities.
        let lag = Matrix::from_rows(&[[-2.0]]).unwrap();
        assert_eq!(windows(&lag, Method::Leapfrog), None);
        let all = windows(&lag, Method::ExplicitEuler).unwrap();
        assert_eq!(all, [StepWindow { from: 0.0, to: 1.0 }]);
    }
}
