//! Steps as matrices of systems in files, against closed forms.

use super::read;
use super::verdicts::{examined, force, system};

#[test]
fn a_step_on_coupled_springs_has_the_eigenvalues_of_its_modes() {
    // Two masses between three springs: ω² is 1 and 3, and velocity Verlet has z + 1/z = 2 − ω²h² in each mode.
    let springs = system(
        "coordinates = [\"a\", \"b\"]\nacceleration.a = \"b - 2*a\"\nacceleration.b = \"a - 2*b\"\n\
         start = { a = 1.0 }\n",
    );
    let h = 0.2_f64;
    let matrix = examined(&springs, "velocity-verlet", h, 10).matrix.unwrap();
    let cosine = |omega2: f64| 1.0 - omega2 * h * h / 2.0;
    for value in &matrix.eigenvalues {
        let nearest = [1.0, 3.0].map(|omega2| (value[0] - cosine(omega2)).abs());
        assert!(nearest[0].min(nearest[1]) < 1e-15, "{value:?}");
        assert!((value[0].hypot(value[1]) - 1.0).abs() < 1e-15, "{value:?}");
    }
    assert_eq!((matrix.determinant, matrix.symplecticity_defect), (1.0, 0.0));
    assert_eq!((matrix.reversibility_defect, matrix.force_evaluations_per_step), (0.0, 2));
    // The fast mode turns too far by acos(1 − ω²h²/2) − ωh.
    let error = cosine(3.0).acos() - 3.0_f64.sqrt() * h;
    assert!((matrix.phase_error_per_step.unwrap() / error - 1.0).abs() < 1e-12);
}

#[test]
fn a_step_of_explicit_euler_adds_the_square_of_the_step_to_areas() {
    // det [[1, h], [−k h, 1]] = 1 + k h² with k = cos q at the start.
    let matrix = examined(&force("-sin(q0)"), "explicit-euler", 1e-6, 10).matrix.unwrap();
    let excess = 1.0_f64.cos() * 1e-12;
    assert!((matrix.determinant_minus_one / excess - 1.0).abs() < 1e-14);
}

#[test]
fn states_of_first_order_have_no_matrix_of_positions_and_velocities() {
    assert!(examined(&read("lorenz"), "rk4", 0.01, 10).matrix.is_none());
    // |q| has no derivative at 0.
    let kinked =
        system("coordinates = [\"q\"]\nacceleration.q = \"-sqrt(abs(q))\"\nstart = { q = 0.0 }\n");
    assert!(examined(&kinked, "rk4", 0.01, 10).matrix.is_none());
}
