use libration_core::number::Dual;
use libration_core::system::{DampedOscillator, Differentiated};
use libration_core::{ImplicitMethod, Scalar};
use libration_linear::eigenvalues;

use super::*;
use crate::UpdateMatrix;

#[test]
fn the_step_on_a_plant_has_the_bits_of_the_step_on_the_same_system_of_the_catalogue() {
    let (omega2, gamma, dt) = (7.0, 0.3, 0.11);
    let a = Matrix::from_rows(&[[0.0, 1.0], [-omega2, -gamma]]).unwrap();
    let stepper = LinearStepper::new(&a).unwrap();
    let number = Dual::<f64>::from_f64;
    let system = DampedOscillator { omega2: number(omega2), gamma: number(gamma) };
    for method in AnyMethod::all() {
        let wanted = UpdateMatrix::from_map(|e| method.step(&Differentiated(system), e, dt));
        let found = stepper.with_step::<f64>(method, dt).unwrap().update_matrix();
        for (i, row) in wanted.rows().iter().enumerate() {
            // −ω²q − γv in another order of signs.
            assert_eq!(found.row(i), row, "{}", method.name());
        }
    }
}

/// A plant of `d` masses with springs and dampers between all of them, of no proportion and no symmetry.
fn plant(d: usize) -> Matrix {
    let part = |i: usize, j: usize| (0.618_034 * (1.0 + (3 * i + 7 * j) as f64)).fract();
    Matrix::from_fn(2 * d, 2 * d, |i, j| match (i < d, j < d) {
        (true, _) => f64::from(u8::from(j == i + d)),
        (false, true) if i - d == j => -40.0 - j as f64,
        (false, false) if i == j => -3.0,
        (false, true) => part(i - d, j) - 0.5,
        (false, false) => 0.1 * part(j - d, i - d),
    })
}

#[test]
fn update_matrices_of_fifty_degrees_of_freedom_solve_the_equations_of_their_methods() {
    let d = 50;
    let a = plant(d);
    let (n, h) = (2 * d, 0.3);
    let stepper = LinearStepper::new(&a).unwrap();
    let identity = Matrix::identity(n);
    let plus = |factor: f64, other: &Matrix| identity.plus(&other.scaled(factor));
    // The parts of A that are treated implicitly in Δv, as rows of a matrix on velocities.
    let (stiffness, damping) = (a.block((d, 0), (d, d)), a.block((d, d), (d, d)));
    for method in ImplicitMethod::ALL {
        let found = stepper.with_step::<f64>(method, h).unwrap().update_matrix();
        let (left, right) = match method {
            ImplicitMethod::DampingStiffnessImplicit | ImplicitMethod::BackwardEuler => {
                (plus(-h, &a), identity.clone())
            }
            ImplicitMethod::ImplicitMidpoint | ImplicitMethod::Trapezoid => {
                (plus(-h / 2.0, &a), plus(h / 2.0, &a))
            }
            ImplicitMethod::GaussLegendre4 | ImplicitMethod::GaussLegendre6 => {
                let coefficients: &[f64] = match method {
                    ImplicitMethod::GaussLegendre4 => &[1.0, 0.5, 1.0 / 12.0],
                    _ => &[1.0, 0.5, 0.1, 1.0 / 120.0],
                };
                let pade = |h: f64| {
                    let zero = Matrix::zeros(n, n);
                    coefficients
                        .iter()
                        .rev()
                        .fold(zero, |sum, &c| (&sum * &a).scaled(h).plus(&identity.scaled(c)))
                };
                (pade(-h), pade(h))
            }
            // (1 − hA_v)v' = v + h(A_q q + p·h·A_q v), with p = 1 for stable PD; q' − hv' = q.
            ImplicitMethod::DampingImplicit | ImplicitMethod::StablePd => {
                let p = if method == ImplicitMethod::StablePd { h * h } else { 0.0 };
                let unit = |i: usize, j: usize| f64::from(u8::from(i == j));
                let left = Matrix::from_fn(n, n, |i, j| match (i < d, j < d) {
                    (true, true) => unit(i, j),
                    (true, false) => -h * unit(i, j - d),
                    (false, true) => 0.0,
                    (false, false) => unit(i, j) - h * damping[(i - d, j - d)],
                });
                let right = Matrix::from_fn(n, n, |i, j| match (i < d, j < d) {
                    (true, _) => unit(i, j),
                    (false, true) => h * stiffness[(i - d, j)],
                    (false, false) => unit(i, j) + p * stiffness[(i - d, j - d)],
                });
                (left, right)
            }
        };
        let mut off = &left * &found;
        off.add_scaled(-1.0, &right);
        // A hundred products of numbers up to 27.
        assert!(off.largest() < 1e-12, "{method:?} {}", off.largest());
    }
}

#[test]
fn equations_of_different_steps_are_not_confused() {
    let a = Matrix::from_rows(&[[0.0, 1.0], [-8.0, -2.0]]).unwrap();
    let stepper = LinearStepper::new(&a).unwrap();
    let step = stepper.with_step::<f64>(ImplicitMethod::StablePd, 0.1).unwrap();
    let at = State::origin();
    let mut right = [0.0; HALF];
    right[0] = 1.0;
    assert_eq!(step.solve_damping(&at, 0.5, right)[0], 1.0 / 2.0);
    assert_eq!(step.solve_damping_and_stiffness(&at, 0.5, right)[0], 1.0 / 4.0);
    assert_eq!(step.solve_damping(&at, 1.5, right)[0], 1.0 / 4.0);
}

#[test]
fn first_order_plants_have_the_multipliers_of_the_stability_function() {
    let a = Matrix::from_rows(&[[-1.0, 0.5, 0.0], [0.25, -2.0, 3.0], [1.0, 0.0, -4.0]]).unwrap();
    let stepper = LinearStepper::new(&a).unwrap();
    assert!(!stepper.is_mechanical() && !stepper.applies(ImplicitMethod::StablePd));
    let h = 0.7;
    let step = stepper.with_step::<f64>(ImplicitMethod::Trapezoid, h).unwrap();
    let found = step.update_matrix();
    let half = |sign: f64| Matrix::identity(3).plus(&a.scaled(sign * h / 2.0));
    let mut off = &half(-1.0) * &found;
    off.add_scaled(-1.0, &half(1.0));
    assert!(off.largest() < 2e-15, "{off:?}");
    // 1 ± z/2 + z²/12.
    let step = stepper.with_step::<f64>(ImplicitMethod::GaussLegendre4, h).unwrap();
    let twelfth = (&a * &a).scaled(h * h / 12.0);
    let mut off = &half(-1.0).plus(&twelfth) * &step.update_matrix();
    off.add_scaled(-1.0, &half(1.0).plus(&twelfth));
    assert!(off.largest() < 2e-15, "{off:?}");
    let radius =
        |m: &Matrix| eigenvalues(m).unwrap().iter().map(|value| value.norm()).fold(0.0, f64::max);
    assert!(radius(&found) < 1.0);
}
