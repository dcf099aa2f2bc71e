//! What several tests of bodies need.

use libration_batch::ensemble::Execution;
use libration_bodies::{Bodies, BodyIntegrator, BodySimulation};

pub(crate) fn simulation(bodies: Bodies, integrator: &str, dt: f64) -> BodySimulation {
    let integrator = BodyIntegrator::from_name(integrator).unwrap();
    BodySimulation::new(bodies, integrator, dt, false, Execution::serial()).unwrap()
}

/// The largest relative change of the energy at `samples` equal parts of the motion.
pub(crate) fn energy_error(simulation: &mut BodySimulation, steps: u64, samples: u64) -> f64 {
    let start = simulation.conserved().energy;
    let mut largest: f64 = 0.0;
    for _ in 0..samples {
        simulation.advance(steps / samples).unwrap();
        largest = largest.max((simulation.conserved().energy / start - 1.0).abs());
    }
    largest
}
