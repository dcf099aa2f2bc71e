//! Systems of the catalogue, written as equations.

use libration_core::system::{
    DampedOscillator, DrivenOscillator, Duffing, HenonHeiles, Kepler, Oscillator, Pendulum,
};
use libration_core::{Float, Integrator, Method, Model, State};
use libration_equations::{Definitions, Equations, StepProgram};

fn definitions(accelerations: &[(&str, &str)], parameters: &[(&str, f64)]) -> Definitions {
    let texts = |pairs: &[(&str, &str)]| -> Vec<(String, String)> {
        pairs.iter().map(|(a, b)| (a.to_string(), b.to_string())).collect()
    };
    Definitions {
        coordinates: accelerations.iter().map(|(name, _)| name.to_string()).collect(),
        accelerations: texts(accelerations),
        parameters: parameters.iter().map(|(name, value)| (name.to_string(), *value)).collect(),
        ..Definitions::default()
    }
}

/// Asserts that ten steps have the same bits.
fn check<S: Float, M: Model<D>, const D: usize>(
    method: impl Integrator,
    model: M,
    equations: &Equations,
    start: State<f64, D>,
) {
    let step = StepProgram::new(method, equations.dynamics());
    let dt = S::from_f64(0.0123);
    let mut run = step.program().on::<S>();
    let mut state = start.map(S::from_f64);
    let mut own: Vec<S> = state.coordinates().collect();
    let system = model.on::<S>();
    for _ in 0..10 {
        state = method.step(&system, state, dt);
        let inputs: Vec<S> = own.iter().copied().chain([dt]).collect();
        own = run.run(&inputs).collect();
        let wanted: Vec<S> = state.coordinates().collect();
        assert_eq!(format!("{own:?}"), format!("{wanted:?}"));
    }
}

fn all<M: Model<D>, const D: usize>(model: M, equations: &Definitions, start: State<f64, D>) {
    let equations = Equations::new(equations).unwrap_or_else(|error| panic!("{error}"));
    for method in Method::ALL {
        check::<f64, M, D>(method, model, &equations, start);
        check::<f32, M, D>(method, model, &equations, start);
        check::<half::f16, M, D>(method, model, &equations, start);
    }
}

#[test]
fn steps_of_the_catalogue_written_as_equations_have_the_bits_of_the_compiled_ones() {
    let start = State { q: [1.3], v: [-0.4] };
    all(
        Oscillator { omega2: 10.3 },
        &definitions(&[("x", "-omega2 * x")], &[("omega2", 10.3)]),
        start,
    );
    all(Pendulum { omega2: 9.81 }, &definitions(&[("x", "-g * sin(x)")], &[("g", 9.81)]), start);
    all(
        Duffing { alpha: -1.1, beta: 0.7 },
        &definitions(&[("x", "-alpha * x - beta * x^3")], &[("alpha", -1.1), ("beta", 0.7)]),
        start,
    );
    all(
        DampedOscillator { omega2: 10.3, gamma: 0.3 },
        &definitions(&[("x", "-omega2 * x - gamma * x'")], &[("omega2", 10.3), ("gamma", 0.3)]),
        start,
    );
    let start = State { q: [0.4, 0.1], v: [-0.2, 1.9] };
    all(
        Kepler { mu: 1.1 },
        &definitions(
            &[
                ("x", "-mu * (1 / sqrt(x*x + y*y))^3 * x"),
                ("y", "-mu * (1 / sqrt(x*x + y*y))^3 * y"),
            ],
            &[("mu", 1.1)],
        ),
        start,
    );
    all(
        HenonHeiles { lambda: 0.9 },
        &definitions(
            &[("x", "-x - lambda * (x*y + x*y)"), ("y", "-y - lambda * (x*x - y*y)")],
            &[("lambda", 0.9)],
        ),
        start,
    );
    let start = State { q: [0.4, 0.0], v: [-0.2, 1.0] };
    all(
        DrivenOscillator { omega2: 10.3, gamma: 0.3, amplitude: 0.7, drive: 3.1 },
        &definitions(
            &[("x", "-omega2*x - gamma*x' + amplitude*cos(drive*t)")],
            &[("omega2", 10.3), ("gamma", 0.3), ("amplitude", 0.7), ("drive", 3.1)],
        ),
        start,
    );
}
