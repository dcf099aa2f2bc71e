//! Tests of analyses and trajectories with implicit integrators.

use libration::ensemble::dynamics_of;
use libration::equations::{Definitions, Equations, StepProgram};
use libration::{AnySystem, ImplicitMethod, Method};
use libration_analyze::export::Values;
use libration_analyze::step_order;
use libration_analyze::trajectory::{EnsembleOptions, FloatType, Request, simulate};
use libration_analyze::{Criteria, Stepping, Timing, analyze};

use super::requests::at;
use super::trajectory::request;

fn of(system: &str, method: ImplicitMethod, dt: f64) -> libration_analyze::Request {
    let system = AnySystem::build(system, &[] as &[(&str, f64)]).unwrap();
    libration_analyze::Request {
        system: at(system, &[0.0], &[0.0]),
        stepping: Stepping::Implicit(method),
        dt,
        steps: 100,
        criteria: Criteria::default(),
        timing: Timing::default(),
    }
}

/// The matrix of each method on `q̈ = −ω²q`, derived by hand.
fn by_hand(method: ImplicitMethod, omega2: f64, h: f64) -> [[f64; 2]; 2] {
    let z2 = omega2 * h * h;
    let over = |den: f64, rows: [[f64; 2]; 2]| rows.map(|row| row.map(|x| x / den));
    match method {
        ImplicitMethod::DampingImplicit => [[1.0 - z2, h], [-omega2 * h, 1.0]],
        ImplicitMethod::StablePd => [[1.0 - z2, h * (1.0 - z2)], [-omega2 * h, 1.0 - z2]],
        ImplicitMethod::DampingStiffnessImplicit | ImplicitMethod::BackwardEuler => {
            over(1.0 + z2, [[1.0, h], [-omega2 * h, 1.0]])
        }
        ImplicitMethod::ImplicitMidpoint | ImplicitMethod::Trapezoid => {
            let d = 1.0 - z2 / 4.0;
            over(1.0 + z2 / 4.0, [[d, h], [-omega2 * h, d]])
        }
        // N²/|N|² at the imaginary z, for the numerator N of the diagonal Padé approximant.
        ImplicitMethod::GaussLegendre4 | ImplicitMethod::GaussLegendre6 => {
            let (re, im) = match method {
                ImplicitMethod::GaussLegendre4 => (1.0 - z2 / 12.0, h / 2.0),
                _ => (1.0 - z2 / 10.0, h / 2.0 - h * z2 / 120.0),
            };
            let (turned, q) = (re * re - omega2 * im * im, 2.0 * re * im);
            over(re * re + omega2 * im * im, [[turned, q], [-omega2 * q, turned]])
        }
    }
}

#[test]
fn matrices_of_oscillators_and_of_pendulums_at_rest_are_those_derived_by_hand() {
    for (system, omega2) in [("oscillator", 10.0), ("pendulum", 9.81)] {
        for method in ImplicitMethod::ALL {
            let h = 0.37;
            let analysis = analyze(&of(system, method, h)).unwrap();
            let wanted = by_hand(method, omega2, h);
            for (row, wanted) in analysis.matrix.as_ref().unwrap().update_matrix.iter().zip(&wanted)
            {
                for (found, wanted) in row.iter().zip(wanted) {
                    assert!((found - wanted).abs() < 1e-14, "{method:?} {found} {wanted}");
                }
            }
            let excess = match method {
                ImplicitMethod::DampingImplicit
                | ImplicitMethod::ImplicitMidpoint
                | ImplicitMethod::Trapezoid
                | ImplicitMethod::GaussLegendre4
                | ImplicitMethod::GaussLegendre6 => 0.0,
                ImplicitMethod::StablePd => -omega2 * h * h,
                _ => (1.0 + omega2 * h * h).recip() - 1.0,
            };
            assert!(
                (analysis.matrix.as_ref().unwrap().determinant_minus_one - excess).abs() < 1e-15,
                "{method:?}"
            );
        }
    }
}

#[test]
fn matrices_in_z_and_windows_are_exact() {
    let analysis = analyze(&of("oscillator", ImplicitMethod::ImplicitMidpoint, 0.1)).unwrap();
    let in_z = analysis.update_matrix_in_z.unwrap();
    assert_eq!(in_z[0], ["(1 − z²/4)/(1 + z²/4)", "z/(1 + z²/4)"]);
    assert_eq!(analysis.stability_windows, Some(vec![[Some(0.0), None]]));
    assert_eq!(analysis.bounded, Some(true));
    // At the limit and beyond: 2(ζ + √(1 + ζ²)) of the default damping.
    let request = of("damped-oscillator", ImplicitMethod::DampingImplicit, 0.1);
    let Some(AnySystem::DampedOscillator(system)) = request.system.twin.map(|twin| twin.system)
    else {
        panic!()
    };
    let omega = system.omega2.sqrt();
    let zeta = 0.5 * system.gamma / omega;
    let limit = 2.0 * (zeta + (1.0 + zeta * zeta).sqrt()) / omega;
    let windows = analyze(&request).unwrap().stability_windows.unwrap();
    assert!((windows[0][1].unwrap() / limit - 1.0).abs() < 1e-14, "{windows:?} {limit}");
    for (dt, bounded) in [(limit * (1.0 - 1e-9), true), (limit * (1.0 + 1e-9), false)] {
        let analysis = analyze(&of("damped-oscillator", ImplicitMethod::DampingImplicit, dt));
        assert_eq!(analysis.unwrap().bounded, Some(bounded));
    }
}

#[test]
fn criteria_and_loops_refuse_implicit_integrators_and_name_the_option() {
    let method = ImplicitMethod::BackwardEuler;
    let criteria = Criteria { max_drift: Some(0.1), ..Criteria::default() };
    let error = analyze(&libration_analyze::Request { criteria, ..of("oscillator", method, 0.1) });
    let text = error.unwrap_err().to_string();
    assert!(
        text.starts_with("--integrator backward-euler") && text.contains("--max-drift"),
        "{text}"
    );
    let feedback = Some(libration::control::Feedback { position: 1.0, velocity: 1.0 });
    let timing = Timing { feedback, ..Timing::default() };
    let step = libration_analyze::Request { timing, ..of("oscillator", method, 0.1) };
    let text = analyze(&step).unwrap_err().to_string();
    assert!(text.contains("--feedback"), "{text}");
    let looped = Request {
        stepping: Stepping::Implicit(method),
        timing,
        ..request("oscillator", Method::Rk4, 0.1, 10)
    };
    let text = simulate(&looped).unwrap_err().to_string();
    assert!(text.contains("backward-euler with --feedback"), "{text}");
}

fn column(request: &Request, name: &str) -> Vec<f64> {
    match simulate(request).unwrap().table.column(name) {
        Some(Values::F64(values)) => values.to_vec(),
        Some(Values::F32(values)) => values.iter().map(|&x| f64::from(x)).collect(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn trajectories_have_the_same_bits_alone_and_as_one_of_many() {
    for system in ["oscillator", "damped-oscillator", "pendulum", "duffing"] {
        for method in ImplicitMethod::ALL {
            for float in [FloatType::F64, FloatType::F32] {
                let stepping = Stepping::Implicit(method);
                let alone = Request {
                    stepping,
                    float,
                    every: 100,
                    ..request(system, Method::Rk4, 0.05, 100)
                };
                let ensemble =
                    EnsembleOptions { count: 3, spread: 0.0, threads: 1, instructions: None };
                let many = Request { ensemble: Some(ensemble), ..alone.clone() };
                for name in ["q", "q'"] {
                    let (one, all) = (column(&alone, name), column(&many, name));
                    assert_eq!(all[3..], [one[1]; 3], "{system} {method:?} {float:?}");
                }
            }
        }
    }
}

#[test]
fn orders_derived_with_1024_bits_are_those_of_the_methods() {
    let system = AnySystem::build("henon-heiles", &[] as &[(&str, f64)]).unwrap();
    let dynamics = dynamics_of(system, 2).unwrap();
    for method in ImplicitMethod::ALL {
        let step = StepProgram::implicit(method, &dynamics);
        // Small steps, in which the rounding of a root to 53 bits would be the largest error.
        let order = step_order(&step, &[0.3, -0.2, 0.3, 0.15], &[0, 1, 2, 3], 0.05);
        assert_eq!(order, Some(method.order()), "{method:?}");
    }
}

#[test]
fn weak_friction_beside_a_stiff_spring_leaves_each_step_its_order() {
    // Drag of 0.05/s beside a rope of 400/s²: in some of these steps the second term of the error is as large as the first.
    let pull = "400*(1 - 5/sqrt(x^2 + z^2))";
    let system = Definitions {
        coordinates: vec!["x".into(), "z".into()],
        accelerations: vec![
            ("x".into(), format!("-x*{pull} - 0.05*x'")),
            ("z".into(), format!("-z*{pull} - 9.81")),
        ],
        ..Definitions::default()
    };
    let equations = Equations::new(&system).unwrap();
    for (method, order) in
        [(Method::Rk4, 4), (Method::VelocityVerlet, 1), (Method::ExplicitEuler, 1)]
    {
        let step = StepProgram::new(method, equations.dynamics());
        for dt in [0.005, 0.05, 0.078_125, 0.156_25, 0.3] {
            let found = step_order(&step, &[2.0, -4.7, 0.0, 0.0], &[0, 1, 2, 3], dt);
            assert_eq!(found, Some(order), "{method:?} {dt}");
        }
    }
}
