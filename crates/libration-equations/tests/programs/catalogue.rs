//! Systems of the catalogue, written as equations.

use libration_core::catalog::{Actuation, ENTRIES, build};
use libration_core::system::{
    DampedOscillator, DrivenOscillator, Duffing, HenonHeiles, Kepler, Oscillator, Pendulum,
};
use libration_core::{AnySystem, Float, Integrator, Method, Model, State, with_system};
use libration_equations::{Definitions, Dynamics, Equations, StepProgram};

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

#[test]
fn steps_of_the_catalogue_written_as_equations_have_the_bits_of_the_compiled_ones() {
    for system in [
        AnySystem::Oscillator(Oscillator { omega2: 10.3 }),
        AnySystem::DampedOscillator(DampedOscillator { omega2: 10.3, gamma: 0.3 }),
        AnySystem::DrivenOscillator(DrivenOscillator {
            omega2: 10.3,
            gamma: 0.3,
            amplitude: 0.7,
            drive: 3.1,
        }),
        AnySystem::Pendulum(Pendulum { omega2: 9.81 }),
        AnySystem::Duffing(Duffing { alpha: -1.1, beta: 0.7 }),
        AnySystem::Kepler(Kepler { mu: 1.1 }),
        AnySystem::HenonHeiles(HenonHeiles { lambda: 0.9 }),
    ] {
        let free = Definitions::of_catalogue(system, Actuation::Acceleration);
        let equations = Equations::new(&free).unwrap_or_else(|error| panic!("{error}"));
        let d = *system.entry().dimensions.start();
        with_system!(
            system,
            d,
            |model, D| {
                // The driven oscillator has its time as a degree of its own.
                let start = match system {
                    AnySystem::DrivenOscillator(_) => ([0.4, 0.0], [-0.2, 1.0]),
                    _ => ([0.4, 0.1], [-0.2, 1.9]),
                };
                let part = |of: [f64; 2]| core::array::from_fn::<f64, D, _>(|i| of[i]);
                let start = State { q: part(start.0), v: part(start.1) };
                for method in Method::ALL {
                    check::<f64, _, D>(method, model, &equations, start);
                    check::<f32, _, D>(method, model, &equations, start);
                    check::<half::f16, _, D>(method, model, &equations, start);
                }
            },
            panic!("{} has {d} dimensions", system.name())
        );
    }
}

#[test]
fn energies_and_commands_of_the_catalogue_are_those_of_the_compiled_systems() {
    let at = [0.7, -0.3, 0.4, 0.9];
    for entry in ENTRIES {
        let none: [(&str, f64); 0] = [];
        let system = AnySystem::build(entry.name, &none).unwrap();
        let free = Definitions::of_catalogue(system, Actuation::Acceleration);
        let own = Equations::new(&free).unwrap();
        let d = *entry.dimensions.start();
        let other = with_system!(system, d, |model, D| Dynamics::of::<D>(&model, None), {
            panic!("{} has {d} dimensions", entry.name)
        });
        let state: Vec<f64> = [&at[..d], &at[2..2 + d]].concat();
        let energy = |dynamics: &Dynamics| -> f64 {
            dynamics.energy().unwrap().on::<f64>().run(&state).next().unwrap()
        };
        let [own, other] = [own.dynamics(), &other].map(energy);
        assert_eq!(own.to_bits(), other.to_bits(), "{}: {own} is not {other}", entry.name);
    }
    // A force of 3 N on 2 kg at 1 m on a spring of 8 N/m.
    let (system, actuation) = build("oscillator", &[("m", 2.0), ("k", 8.0)]).unwrap();
    let commanded = Definitions::of_catalogue(system, actuation).commanded(actuation);
    let equations = Equations::new(&commanded).unwrap();
    let acceleration: Vec<f64> =
        equations.dynamics().accelerations().on::<f64>().run(&[1.0, 0.0, 3.0]).collect();
    assert_eq!((acceleration, commanded.inputs), (vec![-2.5], vec!["u".to_owned()]));
    let [x, y] = build("kepler", &[("mu", 1.0)])
        .map(|(system, actuation)| {
            Definitions::of_catalogue(system, actuation).commanded(actuation)
        })
        .unwrap()
        .inputs
        .try_into()
        .unwrap();
    assert_eq!([x, y], ["u_x", "u_y"]);
}
