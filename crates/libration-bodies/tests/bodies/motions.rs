//! Motions of bodies against published figures and closed forms.

#![allow(missing_docs, clippy::unwrap_used)]

use super::common::{energy_error, simulation};
use libration_batch::ensemble::Execution;
use libration_bodies::{
    Bodies, BodiesError, Body, BodyIntegrator, BodySimulation, InitialConditions, KOZAI_TILT,
    OrbitsAndKicks,
};
use libration_core::Method;

#[test]
fn the_figure_eight_returns_after_its_published_period() {
    let start = InitialConditions::FigureEight.bodies(0, 0).unwrap();
    let steps = 1 << 10;
    let mut moved = simulation(start.clone(), "blanes-moan-srkn-11-6", 6.325_913_98 / steps as f64);
    moved.advance(steps).unwrap();
    for (body, first) in moved.bodies().iter().zip(start.iter()) {
        for axis in 0..3 {
            // The published numbers have eight digits.
            assert!((body.position[axis] - first.position[axis]).abs() < 2e-7);
            assert!((body.velocity[axis] - first.velocity[axis]).abs() < 2e-7);
        }
    }
}

#[test]
fn errors_of_the_energy_fall_with_the_order_of_the_integrator() {
    for (name, order) in [("leapfrog", 2), ("yoshida4", 4), ("rk4", 4), ("kahan-li-6-9a", 6)] {
        let error = |steps: u64| {
            let bodies = InitialConditions::FigureEight.bodies(0, 0).unwrap();
            let mut moved = simulation(bodies, name, 6.3 / steps as f64);
            energy_error(&mut moved, steps, 64)
        };
        let measured = (error(256) / error(512)).log2();
        // The energy error of RK4 on a motion that is nearly its own mirror image has the next order.
        let allowed = if name == "rk4" { 0.6..1.5 } else { -0.3..0.5 };
        assert!(allowed.contains(&(measured - f64::from(order))), "{name}: {measured}");
    }
}

#[test]
fn a_tilted_orbit_reaches_the_eccentricity_of_kozai() {
    let bodies = InitialConditions::Kozai.bodies(0, 0).unwrap();
    let mut moved = simulation(bodies, "blanes-moan-srkn-11-6", core::f64::consts::TAU / 64.0);
    let mut largest: f64 = 0.0;
    for _ in 0..400 {
        moved.advance(64).unwrap();
        let (star, planet) = (moved.bodies().body(0), moved.bodies().body(1));
        let q: [f64; 3] = core::array::from_fn(|k| planet.position[k] - star.position[k]);
        let v: [f64; 3] = core::array::from_fn(|k| planet.velocity[k] - star.velocity[k]);
        let (distance, square) = (q.map(|x| x * x), v.map(|x| x * x));
        let distance = distance.iter().sum::<f64>().sqrt();
        let square: f64 = square.iter().sum();
        let radial: f64 = q.iter().zip(v).map(|(q, v)| q * v).sum();
        let eccentricity: f64 = (0..3)
            .map(|k| ((square - 1.0 / distance) * q[k] - radial * v[k]).powi(2))
            .sum::<f64>()
            .sqrt();
        largest = largest.max(eccentricity);
    }
    // Kozai 1962, to second order in the ratio of the distances; the next order and the motion of the companion within an orbit add a few
    // percent at a ratio of 1/8.
    let expected = (1.0 - 5.0 / 3.0 * KOZAI_TILT.cos().powi(2)).sqrt();
    assert!((largest - expected).abs() < 0.05, "{largest} {expected}");
}

#[test]
fn a_plummer_sphere_is_in_equilibrium() {
    let bodies = InitialConditions::Plummer.bodies(4096, 1).unwrap();
    let integrator = BodyIntegrator::Method(Method::Leapfrog);
    let start = BodySimulation::new(bodies, integrator, 0.01, false, Execution::serial()).unwrap();
    let conserved = start.conserved();
    // Energies of 4096 draws scatter by some 1/√4096; in the units of Hénon they are 1/4 and −1/2.
    assert!((conserved.kinetic - 0.25).abs() < 0.02, "{}", conserved.kinetic);
    assert!((conserved.potential + 0.5).abs() < 0.03, "{}", conserved.potential);
    assert!(conserved.momentum.iter().all(|p| p.abs() < 1e-15));
}

#[test]
fn momenta_drift_as_predicted_by_rounding() {
    let mut ratios = Vec::new();
    for seed in 0..12 {
        let bodies = InitialConditions::Plummer.bodies(24, seed).unwrap().softening(0.1).unwrap();
        let mut moved = simulation(bodies, "leapfrog", 1e-3);
        let start = moved.conserved();
        let variance = moved.rounding_variance();
        let steps = 400;
        moved.advance(steps).unwrap();
        let end = moved.conserved();
        for axis in 0..3 {
            let pairs = [
                (end.momentum[axis] - start.momentum[axis], variance.momentum[axis]),
                (
                    end.angular_momentum[axis] - start.angular_momentum[axis],
                    variance.angular_momentum[axis],
                ),
            ];
            for (change, variance) in pairs {
                ratios.push(change * change / (variance * steps as f64));
            }
        }
    }
    // 72 squares of normal numbers with mean 1 have a mean within 1 ± 0.17; the state of the cluster changes by a factor of less than 2.
    let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
    assert!((0.5..2.0).contains(&mean), "{mean}");
}

#[test]
fn rounding_is_predicted_far_from_the_origin_and_with_compensated_sums() {
    for (offset, is_compensated, integrator) in [
        (0.0, false, "kahan-li-8-17a"),
        (1e3, false, "kahan-li-8-17a"),
        (0.0, true, "kahan-li-8-17a"),
        (1e3, true, "kahan-li-8-17a"),
        (1e5, true, "kahan-li-8-17a"),
    ] {
        let eight = InitialConditions::FigureEight.bodies(0, 0).unwrap();
        let moved: Vec<Body> = eight
            .iter()
            .map(|mut body| {
                body.position[0] += offset;
                body
            })
            .collect();
        let integrator = BodyIntegrator::from_name(integrator).unwrap();
        let on = Execution::serial();
        let bodies = Bodies::new(&moved).unwrap();
        let mut run = BodySimulation::new(bodies, integrator, 0.01, is_compensated, on).unwrap();
        let (start, steps) = (run.conserved().energy, 2000);
        let variance = run.rounding_variance().energy * steps as f64
            + 9.0 * run.representation_variance().energy;
        let mut largest: f64 = 0.0;
        for _ in 0..100 {
            run.advance(steps / 100).unwrap();
            largest = largest.max((run.conserved().energy - start).abs());
        }
        let ratio = largest / (variance.sqrt() + f64::EPSILON * start.abs());
        assert!((0.1..6.0).contains(&ratio), "{offset} {is_compensated} {ratio}");
    }
}

#[test]
fn a_step_is_stopped_between_its_sums() {
    let bodies = InitialConditions::FigureEight.bodies(0, 0).unwrap();
    let mut moved = simulation(bodies, "rk4", 0.01);
    let asked = core::cell::Cell::new(0);
    let stopped = moved.advance_until(9, &|| {
        asked.set(asked.get() + 1);
        asked.get() > 6
    });
    assert_eq!((stopped, asked.get()), (Err(BodiesError::Stopped), 7));
}

#[test]
fn collisions_and_bodies_at_one_place_are_named() {
    let at = |x: f64, v: f64, radius| Body {
        mass: 1.0,
        position: [x, 0.0, 0.0],
        velocity: [v, 0.0, 0.0],
        radius,
        ..Body::default()
    };
    let leapfrog = BodyIntegrator::Method(Method::Leapfrog);
    let start = |bodies: &[Body], dt| {
        BodySimulation::new(Bodies::new(bodies).unwrap(), leapfrog, dt, false, Execution::serial())
    };
    let mut moved =
        start(&[at(9.0, 0.0, 0.1), at(0.0, 1.0, 0.2), at(1.0, -1.0, 0.1)], 0.01).unwrap();
    let Err(BodiesError::Collision { pair: [1, 2], time, distance, .. }) = moved.advance(1000)
    else {
        panic!("no collision");
    };
    assert!(time > 0.2 && time < 0.5 && distance < 0.3, "{time} {distance}");
    // The step that ends in a collision ends the motion, the last of all included.
    let mut last = start(&[at(0.0, 0.0, 0.1), at(1.0, -1.0, 0.1)], 0.1).unwrap();
    assert!(matches!(last.advance(8), Err(BodiesError::Collision { pair: [0, 1], .. })));
    let same = start(&[at(1.0, 0.0, 0.0), at(2.0, 0.0, 0.0), at(1.0, 0.0, 0.0)], 0.1).unwrap_err();
    assert_eq!(same, BodiesError::SamePlace { pair: [0, 2], time: 0.0 });
    assert_eq!(start(&[at(0.0, 0.0, 0.0)], 0.0).unwrap_err(), BodiesError::TimeStep { dt: 0.0 });
    // Softened bodies may pass through each other.
    let soft = Bodies::new(&[at(1.0, 0.0, 0.0); 2]).unwrap().softening(0.1).unwrap();
    let mut soft = BodySimulation::new(soft, leapfrog, 0.1, false, Execution::serial()).unwrap();
    assert_eq!(soft.advance(3), Ok(()));
}

#[test]
fn numbers_that_are_not_allowed_are_named() {
    let good = Body { mass: 1.0, position: [0.0; 3], velocity: [0.0; 3], ..Body::default() };
    let message = |body: Body| Bodies::new(&[good, body]).unwrap_err().to_string();
    let bad = message(Body { mass: -1.0, ..good });
    assert_eq!(bad, "body 1: mass = -1.0; expected a finite number of at least 0");
    let bad = message(Body { velocity: [0.0, f64::NAN, 0.0], ..good });
    assert_eq!(bad, "body 1: vy = NaN; expected a finite number");
    assert!(Bodies::new(&[]).is_err());
    assert!(Bodies::new(&[good]).unwrap().softening(-1.0).is_err());
    assert!(Bodies::new(&[good]).unwrap().gravitational_constant(f64::INFINITY).is_err());
    let two = Bodies::new(&[good, Body { mass: 2.0, position: [1.0; 3], ..good }]).unwrap();
    let integrator = BodyIntegrator::WisdomHolman(OrbitsAndKicks::Leapfrog);
    let refused = BodySimulation::new(two, integrator, 0.1, false, Execution::serial());
    let message = refused.unwrap_err().to_string();
    assert!(message.contains("expected the heaviest body first"), "{message}");
}
