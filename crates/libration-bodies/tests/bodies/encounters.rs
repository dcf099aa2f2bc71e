//! Steps that follow encounters.

#![allow(clippy::unwrap_used)]

use libration_batch::ensemble::Execution;
use libration_bodies::{
    BodiesError, BodyIntegrator, BodySimulation, InitialConditions, OrbitsAndKicks,
};

fn pythagorean(integrator: &str, dt: f64) -> BodySimulation {
    let bodies = InitialConditions::Pythagorean.bodies(0, 0).unwrap();
    let integrator = BodyIntegrator::from_name(integrator).unwrap();
    BodySimulation::new(bodies, integrator, dt, false, Execution::serial()).unwrap()
}

/// The relative error of the energy at a time, and the steps that it took.
fn energy_error(mut run: BodySimulation, time: f64) -> (f64, u64) {
    let start = run.conserved().energy;
    while run.time() < time {
        run.advance(1).unwrap();
    }
    ((run.conserved().energy / start - 1.0).abs(), run.steps())
}

#[test]
fn adaptive_steps_pass_encounters_that_fixed_ones_do_not() {
    // Bodies 4 and 5 pass each other at some 0.01 near t = 1.88, and nearer later.
    let (adaptive, steps) =
        energy_error(pythagorean("kahan-li-6-9a", 0.01).adaptive().unwrap(), 10.0);
    assert!(adaptive < 1e-6, "{adaptive}");
    let (fixed, _) = energy_error(pythagorean("kahan-li-6-9a", 10.0 / steps as f64), 10.0);
    assert!(fixed > 1e3 * adaptive, "{fixed} {adaptive} {steps}");
}

#[test]
fn a_step_is_as_long_as_the_time_scale_of_all_pairs() {
    let frequency = |run: &BodySimulation| {
        let bodies: Vec<_> = run.bodies().iter().collect();
        let pairs = (0..3).flat_map(|j| (0..j).map(move |i| (i, j)));
        let square = |(i, j): (usize, usize)| {
            let (a, b) = (&bodies[i], &bodies[j]);
            let offset = a.position.iter().zip(b.position).map(|(a, b)| (a - b).powi(2));
            (a.mass + b.mass) / offset.sum::<f64>().powf(1.5)
        };
        pairs.map(square).sum::<f64>().sqrt()
    };
    let dt = 1e-4;
    let mut run = pythagorean("leapfrog", dt).adaptive().unwrap();
    let start = frequency(&run);
    let mut shortest = f64::INFINITY;
    while run.time() < 2.5 {
        let before = run.time();
        run.advance(1).unwrap();
        let length = run.time() - before;
        let ratio = length / (dt * start / frequency(&run));
        assert!((ratio - 1.0).abs() < 0.02, "{ratio} at {before}");
        shortest = length.min(shortest);
    }
    // The first encounter is at a hundredth of the first distances.
    assert!(shortest < dt / 100.0, "{shortest}");
}

#[test]
fn the_published_closest_encounter_is_found() {
    // Szebehely and Peters 1967: bodies 4 and 5 at a distance of 4e-4 at t = 15.8299.
    let mut run = pythagorean("kahan-li-8-17a", 0.01).adaptive().unwrap();
    run.watch_encounters();
    while run.time() < 16.5 {
        run.advance(1).unwrap();
    }
    let (pair, distance, time) = run.closest_encounter().unwrap();
    assert_eq!(pair, [1, 2]);
    assert!((time - 15.8299).abs() < 1e-3, "{time}");
    assert!((distance - 4e-4).abs() < 5e-5, "{distance}");
}

#[test]
fn the_prediction_by_rounding_knows_how_short_adaptive_steps_are() {
    let fixed = pythagorean("leapfrog", 0.01).rounding_variance().energy;
    let mut adaptive = pythagorean("leapfrog", 0.01).adaptive().unwrap();
    assert_eq!(adaptive.rounding_variance().energy, fixed);
    // Into the first encounter, where a step is a small part of the first.
    while adaptive.time() < 1.879 {
        adaptive.advance(1).unwrap();
    }
    let bodies = adaptive.bodies().clone();
    let on = Execution::serial();
    let integrator = BodyIntegrator::from_name("leapfrog").unwrap();
    let there = BodySimulation::new(bodies, integrator, 0.01, false, on).unwrap();
    let ratio = there.rounding_variance().energy / adaptive.rounding_variance().energy;
    assert!(ratio > 10.0, "{ratio}");
}

#[test]
fn adaptive_steps_require_a_symmetric_splitting() {
    for name in ["rk4", "symplectic-euler", "ruth-3", "explicit-euler"] {
        let refused = pythagorean(name, 0.01).adaptive().map(|_| ()).unwrap_err();
        assert!(matches!(refused, BodiesError::Adaptive { .. }), "{name}");
    }
    let planets = InitialConditions::OuterSolarSystem.bodies(0, 0).unwrap();
    let on = Execution::serial();
    let run = BodySimulation::new(
        planets,
        BodyIntegrator::WisdomHolman(OrbitsAndKicks::Leapfrog),
        9.0,
        false,
        on,
    )
    .unwrap();
    assert!(run.adaptive().is_err());
}
