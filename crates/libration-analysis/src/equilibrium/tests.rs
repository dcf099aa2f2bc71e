use libration_equations::{Definitions, Degree, Equations};

use super::*;
use crate::conserved_sums::conserved_sums;

/// A system of first order with its start.
fn rates(all: &[(&str, &str, f64)]) -> (Equations, Vec<f64>) {
    let rates = all.iter().map(|(name, rate, _)| ((*name).into(), (*rate).into())).collect();
    let equations = Equations::new(&Definitions { rates, ..Definitions::default() }).unwrap();
    let zeros = vec![0.0; all.len()];
    (equations, zeros.into_iter().chain(all.iter().map(|(_, _, start)| *start)).collect())
}

/// A system of second order with its start at rest.
fn forces(all: &[(&str, &str, f64)]) -> (Equations, Vec<f64>) {
    let definitions = Definitions {
        coordinates: all.iter().map(|(name, _, _)| (*name).into()).collect(),
        accelerations: all.iter().map(|(name, own, _)| ((*name).into(), (*own).into())).collect(),
        ..Definitions::default()
    };
    let start = all.iter().map(|(_, _, start)| *start).chain(vec![0.0; all.len()]).collect();
    (Equations::new(&definitions).unwrap(), start)
}

fn unknowns(equations: &Equations) -> Vec<usize> {
    let d = equations.degrees().len();
    let place = |(i, degree): (usize, &Degree)| match degree {
        Degree::State(_) => d + i,
        _ => i,
    };
    equations.degrees().iter().enumerate().map(place).collect()
}

fn near((equations, start): &(Equations, Vec<f64>)) -> Result<Equilibrium, Equilibrium> {
    Equilibrium::near(equations.dynamics(), start, &unknowns(equations))
}

/// The equilibrium with the conserved sums of the start.
fn on_sums((equations, start): &(Equations, Vec<f64>)) -> Option<Equilibrium> {
    let places = unknowns(equations);
    let sums = conserved_sums(equations.dynamics(), start, &places);
    Equilibrium::with_sums(equations.dynamics(), start, &places, &sums)
}

fn values((equations, _): &(Equations, Vec<f64>), found: &Equilibrium) -> Vec<f64> {
    unknowns(equations).iter().map(|&place| found.state[place]).collect()
}

fn assert_near(found: &[f64], wanted: &[f64]) {
    let apart = found.iter().zip(wanted).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(found.len() == wanted.len() && apart < 1e-9, "{found:?} {wanted:?}");
}

#[test]
fn a_free_body_rests_in_the_rotation_beside_its_start_and_not_at_zero() {
    // Moments of inertia 1, 2 and 3; all rates are products of two, so that the Jacobian is zero at zero.
    let body = rates(&[("a", "-b*c", 0.01), ("b", "a*c", 1.0), ("c", "-a*b/3", 0.01)]);
    let found = near(&body).unwrap();
    assert_eq!([found.state[3], found.state[5]], [0.0, 0.0]);
    // The nearest of the rotations around an axis, to the parts of the second order.
    assert!((found.state[4] - 1.0).abs() < 1e-3, "{found:?}");
    assert_eq!((found.continuum, found.undecided), (1, 0));
}

#[test]
fn a_mass_on_a_spring_in_the_plane_hangs_or_stands_at_its_equilibrium() {
    for (stiffness, x, y) in
        [(400.0, 1.1, 0.3), (1e6, 1.1, 0.3), (1e6, 1.0, 0.0), (400.0, 0.6, -0.8), (1e6, -0.3, -0.4)]
    {
        let spring = |own: &str| format!("-{stiffness}*{own}*(1 - 1/sqrt(x^2 + y^2))");
        let [first, second] = [spring("x"), spring("y") + " - 9.81"];
        let found = near(&forces(&[("x", &first, x), ("y", &second, y)])).unwrap();
        let [x, y] = [found.state[0], found.state[1]];
        // By hand: x = 0, and the spring is longer or shorter by g/k than its length 1.
        let shift = -9.81 / stiffness;
        let apart = (y - (1.0 + shift)).abs().min((y - (shift - 1.0)).abs());
        assert!(x.abs() < 1e-9 && apart < 1e-9, "{stiffness} {x} {y}");
        assert_eq!((found.continuum, found.undecided), (0, 0));
    }
}

#[test]
fn a_root_at_which_derivatives_vanish_has_derivatives_of_zero_and_decides_nothing() {
    for (system, root) in [
        (rates(&[("x", "-x^3", 1.0)]), 0.0),
        (rates(&[("x", "-(x - 1)^3", 3.0)]), 1.0),
        (rates(&[("x", "x^2", -0.5)]), 0.0),
        (forces(&[("x", "-x^3", 1.0)]), 0.0),
        (forces(&[("x", "-1e6*x^5", 0.1)]), 0.0),
    ] {
        let found = near(&system).unwrap();
        let [x] = values(&system, &found)[..] else { panic!() };
        assert!((x - root).abs() < 1e-3, "{found:?}");
        let place = unknowns(&system.0)[0];
        assert_eq!(found.jacobian[(0, place)], 0.0, "{found:?}");
        assert_eq!((found.continuum, found.undecided), (0, 1), "{found:?}");
    }
}

#[test]
fn equilibria_that_form_a_line_or_a_plane_are_counted() {
    for (system, dimension) in [
        (forces(&[("x", "0*x", 1.0)]), 1),
        // A charge in a magnetic field may rest anywhere.
        (forces(&[("x", "5*y'", 1.0), ("y", "-5*x'", 0.0)]), 2),
        // Two masses with a spring of length 1 between them.
        (forces(&[("x", "y - x - 1", 0.0), ("y", "x - y + 1", 3.0)]), 1),
        (
            rates(&[
                ("a", "-2*a*b + 3*c", 1.0),
                ("b", "-2*a*b + 3*c", 2.0),
                ("c", "2*a*b - 3*c", 0.1),
            ]),
            2,
        ),
        // On a circle of radius 1, and at its centre.
        (rates(&[("x", "x*(1 - x^2 - y^2)", 0.8), ("y", "y*(1 - x^2 - y^2)", 0.1)]), 1),
        (forces(&[("q", "-9.81*sin(q)", 0.3)]), 0),
        (rates(&[("x", "x - x*y", 2.0), ("y", "x*y - y", 1.0)]), 0),
    ] {
        let found = near(&system).unwrap();
        assert_eq!((found.continuum, found.undecided), (dimension, 0), "{found:?}");
    }
}

#[test]
fn sums_that_a_system_conserves_select_the_equilibrium_that_its_start_can_reach() {
    // a + b = 1.001, and one of both is zero.
    let pair = rates(&[("a", "-1000*a*b", 1.0), ("b", "1000*a*b", 0.001)]);
    assert_near(&values(&pair, &on_sums(&pair).unwrap()), &[1.001, 0.0]);
    // c of 2(1.1 − c)(2.1 − c) = 3c.
    let reaction =
        rates(&[("a", "-2*a*b + 3*c", 1.0), ("b", "-2*a*b + 3*c", 2.0), ("c", "2*a*b - 3*c", 0.1)]);
    let c = (9.4 - 51.4_f64.sqrt()) / 4.0;
    assert_near(&values(&reaction, &on_sums(&reaction).unwrap()), &[1.1 - c, 2.1 - c, c]);
    // Robertson's reaction ends with all of it in c.
    let robertson = rates(&[
        ("a", "-0.04*a + 1e4*b*c", 1.0),
        ("b", "0.04*a - 1e4*b*c - 3e7*b^2", 0.0),
        ("c", "3e7*b^2", 0.0),
    ]);
    let end = values(&robertson, &on_sums(&robertson).unwrap());
    assert!((end.iter().sum::<f64>() - 1.0).abs() < 1e-9, "{end:?}");
    assert!((end[2] - 1.0).abs() < 1e-3, "{end:?}");
    // Half of the infected recover already.
    let epidemic =
        rates(&[("s", "-0.5*s*i", 0.99), ("i", "0.5*s*i - 0.1*i", 0.01), ("r", "0.1*i", 0.0)]);
    let end = values(&epidemic, &on_sums(&epidemic).unwrap());
    assert!(end[1] == 0.0 && (end.iter().sum::<f64>() - 1.0).abs() < 1e-9, "{end:?}");
}

#[test]
fn what_has_no_equilibrium_is_refused_with_what_is_left() {
    for system in [
        rates(&[("x", "1 + x^2", 1.0)]),
        rates(&[("x", "exp(-x)", 1.0)]),
        forces(&[("x", "-x/(x^2 + y^2)^1.5", 1.0), ("y", "-y/(x^2 + y^2)^1.5", 0.5)]),
        forces(&[("q", "15 - 14*sin(q)", 0.1)]),
        rates(&[("x", "2 + cos(x)", 0.3)]),
    ] {
        assert!(near(&system).unwrap_err().residual > 0.0);
    }
}

#[test]
fn conserved_sums_are_those_by_hand() {
    let reaction = rates(&[("a", "-2*a*b", 1.0), ("b", "-2*a*b", 2.0), ("c", "2*a*b", 0.5)]);
    let places = unknowns(&reaction.0);
    let sums = conserved_sums(reaction.0.dynamics(), &reaction.1, &places);
    let weights: Vec<&[(usize, f64)]> = sums.iter().map(|sum| &sum.weights[..]).collect();
    assert_eq!(weights, [&[(3, 1.0), (5, 1.0)][..], &[(4, 1.0), (5, 1.0)]]);
    assert_eq!([sums[0].start, sums[1].start], [1.5, 2.5]);
    // Friction alone: the velocity with twice the position, and no other.
    let friction = forces(&[("x", "-2*x'", 1.0)]);
    let sums = conserved_sums(friction.0.dynamics(), &friction.1, &[0, 1]);
    assert_eq!(sums[0].weights, [(0, 1.0), (1, 0.5)]);
    // A pendulum has an energy, which is no sum of states.
    let pendulum = forces(&[("q", "-sin(q)", 1.0)]);
    assert!(conserved_sums(pendulum.0.dynamics(), &pendulum.1, &[0, 1]).is_empty());
}
