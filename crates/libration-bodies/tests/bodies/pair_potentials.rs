//! Forces of pair potentials against gravity, closed forms and published energies.

#![allow(missing_docs, clippy::unwrap_used)]

use libration_batch::ensemble::{Execution, InstructionSet};
use libration_bodies::{
    Bodies, BodiesError, Body, BodyIntegrator, BodySimulation, InitialConditions, PairPotential,
};

const LENNARD_JONES: &str = "4*(1/r^12 - 1/r^6)";

fn simulation(bodies: Bodies, integrator: &str, dt: f64, on: Execution) -> BodySimulation {
    let integrator = BodyIntegrator::from_name(integrator).unwrap();
    BodySimulation::new(bodies, integrator, dt, false, on).unwrap()
}

/// Bodies without gravity.
fn with(bodies: &[Body], potential: &str) -> Bodies {
    let potential = PairPotential::new(potential, &[]).unwrap();
    let bodies = Bodies::new(bodies).unwrap().gravitational_constant(0.0).unwrap();
    bodies.pair_potential(potential).unwrap()
}

fn at(position: [f64; 3]) -> Body {
    Body { mass: 1.0, position, ..Body::default() }
}

#[test]
fn the_potential_of_gravity_as_an_expression_moves_bodies_as_gravity_does() {
    let cluster = InitialConditions::Plummer.bodies(40, 3).unwrap();
    let all: Vec<Body> = cluster.iter().collect();
    let moved = |bodies: Bodies| {
        let mut moved = simulation(bodies, "yoshida4", 0.01, Execution::serial());
        moved.advance(100).unwrap();
        moved
    };
    let gravity = moved(cluster.softening(0.1).unwrap());
    let pairs = moved(with(&all, "-m1*m2/sqrt(r^2 + 0.01)"));
    for (a, b) in gravity.bodies().positions().iter().zip(pairs.bodies().positions()) {
        // Some hundred roundings of sums of about 1, stretched by the motion over two crossing times.
        assert!((a - b).abs() < 1e-12, "{a} {b}");
    }
    let (a, b) = (gravity.conserved(), pairs.conserved());
    assert!((a.energy - b.energy).abs() < 1e-14, "{} {}", a.energy, b.energy);
    // One says what rounding does by counting, the other by a second computation in 106 bits.
    let ratio = pairs.rounding_variance().energy / gravity.rounding_variance().energy;
    assert!((0.2..5.0).contains(&ratio), "{ratio}");
}

#[test]
fn frozen_argon_has_its_published_energy() {
    let argon = InitialConditions::FrozenArgon.bodies(0, 0).unwrap();
    let energy = simulation(argon, "leapfrog", 1e-5, Execution::serial()).conserved().energy;
    // Hairer, Lubich and Wanner, section I.4.2: -1260.2 times the constant of Boltzmann.
    assert!((energy + 1260.2).abs() < 0.05, "{energy}");
}

/// An icosahedron with an atom in the centre, so that neighbours on the surface have the distance 1.0515 times the `radius`.
fn icosahedron(radius: f64) -> Vec<Body> {
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    let scale = radius / (1.0 + golden * golden).sqrt();
    let mut atoms = vec![at([0.0; 3])];
    for (a, b) in [(1.0, golden), (1.0, -golden), (-1.0, golden), (-1.0, -golden)] {
        let (a, b) = (a * scale, b * scale);
        atoms.extend([at([0.0, a, b]), at([a, b, 0.0]), at([b, 0.0, a])]);
    }
    atoms
}

#[test]
fn thirteen_atoms_have_the_published_energy_of_their_ground_state() {
    let energy = |radius: f64| {
        let atoms = with(&icosahedron(radius), LENNARD_JONES);
        simulation(atoms, "leapfrog", 0.01, Execution::serial()).conserved().potential
    };
    let (mut low, mut high) = (1.0, 1.2);
    while high - low > 1e-7 {
        let third = (high - low) / 3.0;
        if energy(low + third) < energy(high - third) { high -= third } else { low += third }
    }
    // D. J. Wales, J. P. K. Doye, Journal of Physical Chemistry A 101, 1997, table 1.
    assert!((energy(low) + 44.326_801).abs() < 1e-6, "{}", energy(low));
}

#[test]
fn two_atoms_vibrate_with_the_frequency_of_their_well() {
    let (rest, amplitude) = (2.0_f64.powf(1.0 / 6.0), 1e-6);
    // The second derivative of the potential at its minimum, over the reduced mass of 1/2.
    let frequency = (2.0 * 72.0 / 2.0_f64.cbrt()).sqrt();
    let quarter = 0.5 * core::f64::consts::PI / frequency;
    let atoms = with(&[at([0.0; 3]), at([rest + amplitude, 0.0, 0.0])], LENNARD_JONES);
    let mut moved = simulation(atoms, "blanes-moan-srkn-14-6", quarter / 64.0, Execution::serial());
    moved.advance(64).unwrap();
    let [a, b] = [0, 1].map(|i| moved.bodies().body(i));
    let speed = b.velocity[0] - a.velocity[0];
    // The next term of the potential is 10 times as large over a length of 1; positions have 16 digits, of 1e-6 thus ten.
    assert!((speed / (amplitude * frequency) + 1.0).abs() < 1e-4, "{speed}");
    assert!((b.position[0] - a.position[0] - rest).abs() < 1e-4 * amplitude);
}

/// Charges and masses of all kinds in a random cluster.
fn ions(count: usize) -> Bodies {
    let cluster = InitialConditions::Plummer.bodies(count, 1).unwrap();
    let ion = |(i, body): (usize, Body)| Body {
        mass: 1.0 + (i % 3) as f64,
        charge: [1.0, -1.0, 0.5][i % 3],
        ..body
    };
    let ions: Vec<Body> = cluster.iter().enumerate().map(ion).collect();
    with(&ions, "q1*q2*exp(-r)/sqrt(r^2 + 0.01) + m1*q2/(1 + r^2)")
}

#[test]
fn the_bits_of_a_motion_depend_on_neither_threads_nor_instructions() {
    let end = |on: Execution| {
        let mut moved = simulation(ions(101), "leapfrog", 0.01, on);
        moved.advance(20).unwrap();
        let bits = |values: &[f64]| values.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        [bits(moved.bodies().positions()), bits(moved.bodies().velocities())]
    };
    let alone = end(Execution::serial());
    for set in InstructionSet::ALL {
        let Ok(serial) = Execution::serial().instructions(set) else { continue };
        for threads in [1, 2, 3, 7] {
            assert_eq!(end(serial.clone().threads(threads).unwrap()), alone, "{set:?} {threads}");
        }
    }
}

#[test]
fn forces_are_opposite_even_where_the_potential_is_not_symmetric() {
    let mut moved = simulation(ions(50), "leapfrog", 0.01, Execution::serial());
    let start = moved.conserved();
    moved.advance(200).unwrap();
    let end = moved.conserved();
    for axis in 0..3 {
        // A random walk of some 200 roundings of velocities of about 1.
        assert!((end.momentum[axis] - start.momentum[axis]).abs() < 1e-12);
        assert!((end.angular_momentum[axis] - start.angular_momentum[axis]).abs() < 1e-12);
    }
    let lost = (end.energy / start.energy - 1.0).abs();
    assert!((1e-9..1e-2).contains(&lost), "{lost}");
}

#[test]
fn what_does_not_go_with_a_pair_potential_is_refused() {
    let massless = Bodies::new(&[at([0.0; 3]), Body::default()]).unwrap();
    let refused = massless.pair_potential(PairPotential::new("r^2", &[]).unwrap());
    assert_eq!(refused, Err(BodiesError::Massless { body: 1 }));
    let two = || with(&[at([0.0; 3]), at([1.0; 3])], "r^2");
    let start = |bodies: Bodies, integrator: &str| {
        let integrator = BodyIntegrator::from_name(integrator).unwrap();
        BodySimulation::new(bodies, integrator, 0.1, false, Execution::serial())
    };
    let softened = start(two().softening(0.1).unwrap(), "leapfrog");
    assert_eq!(softened.err(), Some(BodiesError::NothingToSoften));
    let orbits = start(two(), "wisdom-holman").err().unwrap().to_string();
    assert!(orbits.contains("expected no pair potential"), "{orbits}");
    let adaptive = start(two(), "leapfrog").unwrap().adaptive().err().unwrap().to_string();
    assert!(adaptive.contains("expected no pair potential"), "{adaptive}");
    let unknown = PairPotential::new("q1*q3/r", &[]).unwrap_err();
    assert_eq!((unknown.span, unknown.key.as_str()), (Some(3..5), "pair-potential"));
    let charged = Bodies::new(&[at([0.0; 3]), Body { charge: -0.5, ..at([1.0; 3]) }]).unwrap();
    assert_eq!(charged.ensure_effects(), Err(BodiesError::Charge { body: 1, value: -0.5 }));
    assert_eq!(
        start(charged, "leapfrog").err(),
        Some(BodiesError::Charge { body: 1, value: -0.5 })
    );
    let constant = PairPotential::new("q1*q2", &[]).unwrap_err().to_string();
    assert_eq!(constant, "it does not depend on `r`");
    let unused = PairPotential::new("1/r", &[("k".to_owned(), 1.0)]).unwrap_err().to_string();
    assert!(unused.starts_with("the parameter `k` has no effect"), "{unused}");
    for (name, reason) in [("r", "given twice"), ("pi", "a name of the language"), ("1", "no name")]
    {
        let wrong = PairPotential::new("r", &[(name.to_owned(), 1.0)]).unwrap_err();
        assert!(wrong.to_string().contains(reason), "{wrong}");
    }
    let infinite = PairPotential::new("a/r", &[("a".to_owned(), f64::INFINITY)]).unwrap_err();
    assert!(infinite.to_string().contains("expected a finite number"), "{infinite}");
}

#[test]
fn the_terms_of_a_pair_are_those_of_the_potential_and_its_derivatives() {
    let body = |x: f64| Body {
        mass: 1.0,
        position: [x, 0.0, 0.0],
        velocity: [0.0; 3],
        radius: 0.0,
        charge: 0.0,
    };
    let free = Bodies::new(&[body(0.0), body(1.0)]).unwrap();
    assert_eq!((free.pair_terms(0, 1, 1.5), free.pair_stiffness(0, 1, 1.5)), ([0.0; 2], 0.0));
    let potential = PairPotential::new("4*(r^-12-r^-6)", &[]).unwrap();
    let bound = free.pair_potential(potential).unwrap();
    for r in [0.9_f64, 1.1, 2.0] {
        let (a, b) = (r.powi(-12), r.powi(-6));
        let [energy, slope] = bound.pair_terms(1, 0, r);
        let expected =
            [4.0 * (a - b), 4.0 * (6.0 * b - 12.0 * a) / r, 4.0 * (156.0 * a - 42.0 * b) / (r * r)];
        for (found, expected) in
            [energy, slope, bound.pair_stiffness(1, 0, r)].into_iter().zip(expected)
        {
            // A few roundings of terms of up to 4·156·a.
            assert!(
                (found - expected).abs() < 1e-13 * (1.0 + 700.0 * a),
                "{r}: {found} {expected}"
            );
        }
    }
}
