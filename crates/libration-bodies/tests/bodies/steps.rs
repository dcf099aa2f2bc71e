//! Steps of bodies against ten lines of scalar code.

#![allow(missing_docs, clippy::unwrap_used)]

use libration_batch::ensemble::{Execution, InstructionSet};
use libration_bodies::{Bodies, Body, BodyIntegrator, BodySimulation};
use libration_core::{Integrator, Method, Scalar, State, System, with_method};

/// Three bodies of any masses as a system of nine degrees of freedom, body by body.
struct ThreeBodies([f64; 3]);

impl System<f64, 9> for ThreeBodies {
    const POSITIONAL: bool = true;

    fn acceleration(&self, state: &State<f64, 9>) -> [f64; 9] {
        let mut a = [0.0; 9];
        for i in 0..3 {
            for j in 0..3 {
                if i == j {
                    continue;
                }
                let d: [f64; 3] = core::array::from_fn(|k| state.q[3 * j + k] - state.q[3 * i + k]);
                let square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
                let weight = self.0[j] / (square * square.sqrt());
                for (k, d) in d.into_iter().enumerate() {
                    a[3 * i + k] += weight * d;
                }
            }
        }
        a
    }
}

fn three() -> Vec<Body> {
    let body = |mass, position, velocity| Body { mass, position, velocity, ..Body::default() };
    vec![
        body(1.0, [0.1, -0.3, 0.2], [0.01, 0.2, -0.1]),
        body(0.3, [1.1, 0.7, -0.4], [-0.3, 0.9, 0.2]),
        body(0.05, [-2.0, 1.3, 0.6], [0.2, -0.4, 0.5]),
    ]
}

fn cluster(count: usize) -> Bodies {
    libration_bodies::InitialConditions::Plummer.bodies(count, 3).unwrap()
}

#[test]
fn every_integrator_moves_bodies_with_the_bits_of_its_scalar_step() {
    let bodies = three();
    let masses: Vec<f64> = bodies.iter().map(|body| body.mass).collect();
    let system = ThreeBodies(masses.try_into().unwrap());
    let flat = |of: fn(&Body) -> [f64; 3]| -> [f64; 9] {
        let numbers: Vec<f64> = bodies.iter().flat_map(of).collect();
        numbers.try_into().unwrap()
    };
    let start = State { q: flat(|body| body.position), v: flat(|body| body.velocity) };
    let dt = 0.0173;
    for method in Method::all() {
        let mut state = start;
        with_method!(method, |integrator| {
            for _ in 0..5 {
                state = integrator.step(&system, state, f64::from_f64(dt));
            }
        });
        let mut simulation = BodySimulation::new(
            Bodies::new(&bodies).unwrap(),
            BodyIntegrator::Method(method),
            dt,
            false,
            Execution::serial(),
        )
        .unwrap();
        simulation.advance(5).unwrap();
        for (i, body) in simulation.bodies().iter().enumerate() {
            assert_eq!(body.position[..], state.q[3 * i..3 * i + 3], "{}", method.name());
            assert_eq!(body.velocity[..], state.v[3 * i..3 * i + 3], "{}", method.name());
        }
    }
}

#[test]
fn bits_depend_on_no_thread_and_no_instruction_set() {
    // Not a multiple of the lanes, and bodies without mass at the end.
    let mut bodies: Vec<Body> = cluster(203).iter().collect();
    bodies.iter_mut().skip(190).for_each(|body| body.mass = 0.0);
    let run = |set, threads| {
        let on = Execution::serial().threads(threads).unwrap().instructions(set).unwrap();
        let integrator = BodyIntegrator::Method(Method::Yoshida4);
        // Few pairs are worth a thread here, so that all threads work.
        let bodies = Bodies::new(&bodies).unwrap();
        let mut simulation =
            BodySimulation::new(bodies, integrator, 1e-3, false, on.worth(1)).unwrap();
        simulation.advance(4).unwrap();
        let bits = |planes: &[f64]| planes.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        (bits(simulation.bodies().positions()), bits(simulation.bodies().velocities()))
    };
    let expected = run(InstructionSet::Baseline, 1);
    for set in InstructionSet::available() {
        for threads in [1, 2, 5] {
            assert_eq!(run(set, threads), expected, "{} {threads}", set.name());
        }
    }
}

#[test]
fn forces_are_those_of_a_double_loop_with_softening() {
    let softening = 0.07;
    let bodies = cluster(57).softening(softening).unwrap();
    let dt = 1.0;
    let integrator = BodyIntegrator::Method(Method::ExplicitEuler);
    let mut simulation =
        BodySimulation::new(bodies.clone(), integrator, dt, false, Execution::serial()).unwrap();
    simulation.advance(1).unwrap();
    let all: Vec<Body> = bodies.iter().collect();
    for (i, (body, moved)) in all.iter().zip(simulation.bodies().iter()).enumerate() {
        let mut sum = [0.0; 3];
        for other in all.iter().enumerate().filter(|(j, _)| *j != i).map(|(_, other)| other) {
            let d: [f64; 3] = core::array::from_fn(|k| other.position[k] - body.position[k]);
            let square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2] + softening * softening;
            for (sum, d) in sum.iter_mut().zip(d) {
                *sum += other.mass / (square * square.sqrt()) * d;
            }
        }
        let velocity: [f64; 3] = core::array::from_fn(|k| body.velocity[k] + dt * sum[k]);
        assert_eq!(moved.velocity, velocity, "body {i}");
    }
}

/// The relative error of the energy of the figure-eight after a period, by rounding alone.
fn energy_error(steps: u64, compensated: bool) -> f64 {
    let system = libration_bodies::InitialConditions::FigureEight.bodies(0, 0).unwrap();
    let integrator = BodyIntegrator::from_name("blanes-moan-srkn-11-6").unwrap();
    let dt = 6.325_913_98 / steps as f64;
    let mut simulation =
        BodySimulation::new(system, integrator, dt, compensated, Execution::serial()).unwrap();
    let start = simulation.conserved().energy;
    let mut largest: f64 = 0.0;
    for _ in 0..16 {
        simulation.advance(steps / 16).unwrap();
        largest = largest.max((simulation.conserved().energy / start - 1.0).abs());
    }
    largest
}

#[test]
fn compensated_sums_lose_nothing_where_plain_sums_drift() {
    // At these steps the error of the method is below 1e-17. A random walk of 2¹⁴ · 22 roundings is near 600 · 1e-16 · 0.4; the energy
    // of a state that is rounded once has an error of a few 1e-16.
    let steps = 1 << 14;
    let (plain, compensated) = (energy_error(steps, false), energy_error(steps, true));
    assert!(compensated < 1e-15, "{compensated}");
    assert!(plain > 4.0 * compensated, "{plain} {compensated}");
}
