//! Programs of implicit steps.

use libration_core::integrator::ImplicitIntegrator;
use libration_core::number::Dual;
use libration_core::system::{Differentiated, HenonHeiles, Kepler, Pendulum};
use libration_core::{Float, ImplicitMethod, Model, State};
use libration_equations::{Definitions, Dynamics, Equations, StepProgram};

/// Asserts that ten steps have the same bits.
fn check<S: Float, M: Model<D>, const D: usize>(model: M, start: State<f64, D>) {
    for method in ImplicitMethod::ALL {
        let step = StepProgram::implicit(method, &Dynamics::of(&model, None));
        let mut run = step.program().on::<S>();
        let dt = S::from_f64(0.0123);
        let mut state = start.map(S::from_f64);
        let mut own: Vec<S> = state.coordinates().collect();
        let system = Differentiated(model.on::<Dual<S>>());
        for _ in 0..10 {
            state = method.step(&system, state, dt);
            let inputs: Vec<S> = own.iter().copied().chain([dt]).collect();
            own = run.run(&inputs).collect();
            let wanted: Vec<S> = state.coordinates().collect();
            assert_eq!(format!("{own:?}"), format!("{wanted:?}"), "{method:?}");
        }
    }
}

#[test]
fn programs_of_implicit_steps_have_the_bits_of_the_steps() {
    let start = State { q: [1.3, 0.2], v: [-0.1, 0.9] };
    check::<f64, _, 1>(Pendulum { omega2: 9.81 }, State { q: [1.3], v: [-0.4] });
    check::<f32, _, 1>(Pendulum { omega2: 9.81 }, State { q: [1.3], v: [-0.4] });
    check::<f64, _, 2>(Kepler { mu: 1.1 }, start);
    check::<f64, _, 2>(HenonHeiles { lambda: 0.9 }, start);
}

/// A chain of `n` pendulums with springs and dampers between neighbours.
fn chain(n: usize) -> Equations {
    let names: Vec<String> = (0..n).map(|i| format!("x{i}")).collect();
    let force = |i: usize| {
        let mut text = format!("-9.81*sin(x{i}) - 0.1*x{i}'");
        for j in [i.wrapping_sub(1), i + 1].into_iter().filter(|j| *j < n) {
            text += &format!(" + 50*(x{j} - x{i}) + 2*(x{j}' - x{i}')");
        }
        (names[i].clone(), text)
    };
    let definitions = Definitions {
        coordinates: names.clone(),
        accelerations: (0..n).map(force).collect(),
        ..Definitions::default()
    };
    Equations::new(&definitions).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn a_chain_of_eight_stands_still_in_equilibrium_and_loses_energy_elsewhere() {
    let n = 8;
    let equations = chain(n);
    for method in ImplicitMethod::ALL {
        let step = StepProgram::implicit(method, equations.dynamics());
        let mut run = step.program().on::<f64>();
        let rest: Vec<f64> = run.run(&[vec![0.0; 2 * n], vec![0.05]].concat()).collect();
        assert!(rest.iter().all(|x| *x == 0.0), "{method:?} {rest:?}");
        // The fastest mode has about 14 rad/s and a damping of 0.28.
        let mut state: Vec<f64> = (0..2 * n).map(|i| 0.3 * (i as f64).sin()).collect();
        let size = |state: &[f64]| state.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        for _ in 0..2000 {
            let inputs: Vec<f64> = state.iter().copied().chain([0.05]).collect();
            state = run.run(&inputs).collect();
        }
        assert!(size(&state) < 0.1, "{method:?} {state:?}");
    }
}

#[test]
fn steps_of_a_nonlinear_system_are_those_of_scipy() {
    // `tools/implicit_steps_reference.py`.
    let wanted = [
        (
            ImplicitMethod::DampingImplicit,
            [-0.5905875120844695, 1.6016429731174584, -2.184007747655059, -2.6268485268180246],
        ),
        (
            ImplicitMethod::DampingStiffnessImplicit,
            [-0.4619946812773623, 1.348165660644839, -1.9393442657553035, -2.446967731455445],
        ),
        (
            ImplicitMethod::StablePd,
            [-0.4553816891524419, 1.329666750244787, -1.9591268836733853, -2.4844110543947977],
        ),
        (
            ImplicitMethod::BackwardEuler,
            [-0.4609723662321025, 1.3401925296578816, -1.934527327681823, -2.4019514243079594],
        ),
        (
            ImplicitMethod::ImplicitMidpoint,
            [-0.45071678033499346, 1.6883388770783505, -2.20233200887399, -2.6872293606634434],
        ),
        (
            ImplicitMethod::Trapezoid,
            [-0.4511575579361625, 1.6863538275282697, -2.1995952381337, -2.6700514488616087],
        ),
        (
            ImplicitMethod::GaussLegendre4,
            [-0.4509177910215971, 1.6823917227320548, -2.2040251646793294, -2.681088163588333],
        ),
        (
            ImplicitMethod::GaussLegendre6,
            [-0.4509174775589304, 1.6823980182101381, -2.2040305097923305, -2.6810880686549083],
        ),
    ];
    let pairs = |all: [(&str, &str); 2]| all.map(|(a, b)| (a.to_owned(), b.to_owned())).to_vec();
    let definitions = Definitions {
        coordinates: vec!["x".to_owned(), "y".to_owned()],
        accelerations: pairs([
            ("x", "-2*sin(x) - 0.3*x'*cos(y')"),
            ("y", "3*(x - y) - 0.2*y'^3 + 0.1*x'"),
        ]),
        ..Definitions::default()
    };
    let equations = Equations::new(&definitions).unwrap_or_else(|error| panic!("{error}"));
    for (method, wanted) in wanted {
        let step = StepProgram::implicit(method, equations.dynamics());
        let mut run = step.program().on::<f64>();
        let mut state = vec![1.9, -0.4, 0.6, 1.1];
        for _ in 0..20 {
            state = run.run(&[&state[..], &[0.1]].concat()).collect();
        }
        // SciPy ends its iteration at residuals of some 10⁻¹⁵, twenty times.
        for (found, wanted) in state.iter().zip(wanted) {
            assert!((found - wanted).abs() < 1e-13, "{method:?} {found} {wanted}");
        }
    }
}
