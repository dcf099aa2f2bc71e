//! Tests of trajectories as tables.

use std::sync::atomic::AtomicBool;

use libration::catalog::Actuation;
use libration::control::Jitter;
use libration::{AnySystem, Method, catalog};
use libration_analyze::export::Values;
use libration_analyze::trajectory::{
    EnsembleOptions, FloatType, Format, Outcome, Request, Trajectory, TrajectoryError, simulate,
    write,
};
use libration_analyze::{Stepping, Timing};
use libration_settings::equations::EquationSystem;

/// A system of the catalogue from positions and velocities.
pub(crate) fn from(system: AnySystem, [q, v]: [Vec<f64>; 2]) -> EquationSystem {
    EquationSystem::of_catalogue((system, Actuation::Acceleration), Some(&q), Some(&v)).unwrap()
}

/// The same request from another position, at rest.
pub(crate) fn at(q: f64, request: Request) -> Request {
    let system = request.system.twin.unwrap().system;
    Request { system: from(system, [vec![q], vec![0.0]]), ..request }
}

pub(crate) fn request(system: &str, method: Method, dt: f64, steps: u64) -> Request {
    let one = AnySystem::build(system, &[] as &[(&str, f64)]).unwrap();
    let start = match *one.entry().dimensions.start() {
        1 => [vec![1.0], vec![0.0]],
        _ => [one.entry().q.to_vec(), one.entry().v.to_vec()],
    };
    Request {
        system: from(one, start),
        stepping: method.into(),
        float: FloatType::F64,
        dt,
        steps,
        every: 1,
        ensemble: None,
        timing: Default::default(),
        record: None,
        seed: 0,
    }
}

fn steps(trajectory: &Trajectory) -> Vec<u64> {
    match trajectory.table.column("step") {
        Some(Values::U64(steps)) => steps.to_vec(),
        other => panic!("{other:?}"),
    }
}

fn f64s(trajectory: &Trajectory, name: &str) -> Vec<f64> {
    match trajectory.table.column(name) {
        Some(Values::F64(values)) => values.to_vec(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn the_start_and_the_last_step_are_always_there() {
    let of = |n, every| {
        let request = Request { every, ..request("oscillator", Method::Rk4, 0.01, n) };
        let trajectory = simulate(&request).unwrap();
        assert_eq!(trajectory.outcome, Outcome::Complete);
        assert_eq!(trajectory.table.rows() as u64, request.rows());
        steps(&trajectory)
    };
    assert_eq!(of(10, 1), (0..=10).collect::<Vec<_>>());
    assert_eq!(of(10, 4), [0, 4, 8, 10]);
    assert_eq!(of(8, 4), [0, 4, 8]);
    assert_eq!(of(3, 1000), [0, 3]);
    assert_eq!(of(200_000, 150_000), [0, 150_000, 200_000]);
    assert_eq!(of(1, u64::MAX), [0, 1]);
}

#[test]
fn time_is_the_step_times_dt_to_the_bit() {
    for float in FloatType::ALL {
        let request = Request { float, ..request("oscillator", Method::Leapfrog, 0.01, 1000) };
        let dt = match float {
            FloatType::F64 => 0.01,
            FloatType::F32 => f64::from(0.01_f32),
            FloatType::F16 => f64::from(half::f16::from_f32(0.01)),
            FloatType::Bf16 => f64::from(half::bf16::from_f32(0.01)),
        };
        for (step, t) in f64s(&simulate(&request).unwrap(), "t").into_iter().enumerate() {
            assert_eq!(t, step as f64 * dt);
        }
    }
}

#[test]
fn exact_steps_go_where_the_solution_is_alone_and_in_numbers() {
    let stepping = Stepping::Exact;
    let one = Request { stepping, ..request("oscillator", Method::Rk4, 0.3, 1000) };
    let ensemble = Some(EnsembleOptions { count: 3, spread: 0.0, threads: 1, instructions: None });
    for request in [one.clone(), Request { ensemble, ..one.clone() }] {
        let trajectory = simulate(&request).unwrap();
        let omega = request.system.definitions.parameters[0].1.sqrt();
        for (q, t) in f64s(&trajectory, "q").into_iter().zip(f64s(&trajectory, "t")) {
            // A few units of rounding a step, all to one side at worst, and those of the angle.
            let bound = (8.0 * t / 0.3 + 2.0 * omega * t + 1.0) * f64::EPSILON;
            assert!((q - (omega * t).cos()).abs() <= bound, "{t}: {q}");
        }
    }
    // Under jitter too, in steps up to eighteen times as long.
    let timing = Timing { jitter: Some(Jitter::Gaussian(3.0)), ..Default::default() };
    let jittered = simulate(&Request { timing, dt: 0.15, seed: 3, ..one.clone() }).unwrap();
    let omega = one.system.definitions.parameters[0].1.sqrt();
    for (q, t) in f64s(&jittered, "q").into_iter().zip(f64s(&jittered, "t")) {
        assert!((q - (omega * t).cos()).abs() < 1e-11, "{t}: {q}");
    }
    let pendulum = Request { stepping, ..request("pendulum", Method::Rk4, 0.3, 10) };
    let refused = simulate(&pendulum).unwrap_err().to_string();
    assert!(refused.contains("exact for pendulum") && refused.contains("linear"), "{refused}");
    let refused = simulate(&Request { dt: 1e6, ..one }).unwrap_err().to_string();
    assert!(refused.contains("dt") && refused.contains("32768"), "{refused}");
}

#[test]
fn a_stride_changes_which_rows_are_kept_and_nothing_else() {
    let all = request("oscillator", Method::Rk4, 0.1, 100);
    let some = Request { every: 7, ..all.clone() };
    let (all, some) = (simulate(&all).unwrap(), simulate(&some).unwrap());
    for name in ["t", "q", "q'", "energy"] {
        let column = f64s(&all, name);
        for (step, value) in steps(&some).into_iter().zip(f64s(&some, name)) {
            assert_eq!(column[step as usize], value);
        }
    }
}

/// Explicit Euler on `q'' = -10 q` as plain arithmetic: the first step that overflows.
fn first_overflow(dt: f64) -> u64 {
    let (mut q, mut v, mut step) = (1.0_f64, 0.0_f64, 0);
    while q.is_finite() && v.is_finite() {
        (q, v) = (q + dt * v, v + dt * (-10.0 * q));
        step += 1;
    }
    step
}

#[test]
fn an_overflow_ends_the_rows_at_the_last_finite_state() {
    let step = first_overflow(0.1);
    let never = AtomicBool::new(false);
    for every in [1, 1000, 1_000_000] {
        let request = request("oscillator", Method::ExplicitEuler, 0.1, 100_000);
        let request = Request { every, ..request };
        let trajectory = simulate(&request).unwrap();
        let Outcome::Diverged(stopped) = &trajectory.outcome else { panic!("it overflows") };
        assert_eq!((stopped.step, stopped.t), (step, step as f64 * 0.1));
        assert_eq!(steps(&trajectory).last(), Some(&(step - 1)));
        assert!(f64s(&trajectory, "q").iter().all(|q| q.is_finite()));

        let mut bytes = Vec::new();
        write(&request, Format::Json, &mut bytes, &never).unwrap();
        let json: serde_json::Value = serde_json::from_slice(&bytes).unwrap();
        assert_eq!(json["stopped"]["step"], step);
        assert!(json["stopped"]["reason"].is_string());
        assert_eq!(json["rows"].as_array().unwrap().len(), trajectory.table.rows());
    }
}

#[test]
fn every_system_runs_in_every_float_type_and_format() {
    let never = AtomicBool::new(false);
    for entry in catalog::ENTRIES {
        let d = *entry.dimensions.start();
        for float in FloatType::ALL {
            let one = AnySystem::build(entry.name, &[] as &[(&str, f64)]).unwrap();
            let request = request(entry.name, Method::Yoshida4, 0.0625, 8);
            let system = from(one, [entry.q.to_vec(), entry.v.to_vec()]);
            let request = Request { float, system, ..request };
            // The time of a driven oscillator is in the column `t`.
            let d = if entry.name == "driven-oscillator" { d - 1 } else { d };
            let table = simulate(&request).unwrap().table;
            assert_eq!((table.columns().len(), table.rows()), (2 * d + 3, 9));
            let columns = table.columns().iter().map(|c| (c.name.to_string(), c.unit.to_string()));
            assert_eq!(columns.collect::<Vec<_>>(), request.columns());
            for format in Format::ALL {
                let mut bytes = Vec::new();
                assert_eq!(write(&request, format, &mut bytes, &never).unwrap(), Outcome::Complete);
                assert!(bytes.len() > 9 * (2 * d + 3));
            }
        }
    }
}

#[test]
fn wrong_requests_are_refused_before_any_work() {
    let good = request("oscillator", Method::Rk4, 0.01, 10);
    let f16 = Request { float: FloatType::F16, ..good.clone() };
    let stiff = AnySystem::build("oscillator", &[("omega2", 1e6)]).unwrap();
    let cases = [
        (Request { dt: 0.0, ..good.clone() }, ["`dt`", "0.0", "greater than 0"]),
        (Request { dt: f64::NAN, ..good.clone() }, ["`dt`", "NaN", "finite"]),
        (Request { dt: 1e-9, ..f16.clone() }, ["`dt`", "1e-9", "f16"]),
        (Request { dt: 1e9, ..f16.clone() }, ["`dt`", "inf", "f16"]),
        (at(1e5, f16.clone()), ["`q`", "100000", "finite in f16"]),
        (
            Request { system: from(stiff, [vec![1.0], vec![0.0]]), ..f16 },
            ["`omega2`", "1000000.0", "f16"],
        ),
        (Request { steps: 0, ..good.clone() }, ["`steps`", "0", "at least 1"]),
        (Request { every: 0, ..good.clone() }, ["`every`", "0", "at least 1"]),
        (
            Request { steps: 1 << 50, ..good.clone() },
            ["GB of memory are needed", "--save-every", ""],
        ),
    ];
    for (request, parts) in cases {
        let error = simulate(&request).unwrap_err().to_string();
        for part in parts {
            assert!(error.contains(part), "`{error}` does not mention `{part}`");
        }
    }
}

#[test]
fn a_set_flag_stops_the_work() {
    let request = request("oscillator", Method::Rk4, 0.01, 1_000_000_000);
    let request = Request { every: 1_000_000, ..request };
    let error = write(&request, Format::Csv, &mut Vec::new(), &AtomicBool::new(true)).unwrap_err();
    assert!(matches!(error, TrajectoryError::Interrupted));
}

const COPIES: EnsembleOptions =
    EnsembleOptions { count: 1, spread: 0.0, threads: 0, instructions: None };

#[test]
fn each_of_many_trajectories_has_the_rows_that_it_has_alone() {
    let alone = Request { every: 7, ..request("pendulum", Method::Yoshida4, 0.1, 30) };
    let ensemble = EnsembleOptions { count: 5, spread: 0.5, ..COPIES };
    let many = simulate(&Request { ensemble: Some(ensemble), ..alone.clone() }).unwrap();
    assert_eq!(many.outcome, Outcome::Complete);
    assert_eq!(many.table.rows(), 5 * 6);
    for n in 0..5 {
        let scale = ensemble.scale(n);
        assert_eq!(scale, 0.5 + 0.25 * n as f64);
        let lone = simulate(&at(scale, alone.clone())).unwrap();
        for name in ["q", "q'", "energy"] {
            let of_n: Vec<f64> = f64s(&many, name).into_iter().skip(n).step_by(5).collect();
            assert_eq!(of_n, f64s(&lone, name), "{name} of {n}");
        }
    }
    let Some(Values::U64(numbers)) = many.table.column("trajectory") else { panic!() };
    assert_eq!(numbers[..6], [0, 1, 2, 3, 4, 0]);
}

#[test]
fn one_that_overflows_is_named_and_the_others_go_on() {
    let ensemble = Some(EnsembleOptions { count: 3, spread: 1.0, ..COPIES });
    let unstable = request("oscillator", Method::ExplicitEuler, 0.1, 20_000);
    let request = Request { every: 20_000, ensemble, ..unstable };
    let trajectory = simulate(&request).unwrap();
    // The first starts at rest in the origin, where it stays.
    let Outcome::NotFinite { count, first, reason, .. } = &trajectory.outcome else { panic!() };
    assert_eq!((*count, &**first), (2, &[1, 2][..]));
    assert!(reason.as_ref().is_some_and(|why| why.contains("unstable with every time step")));
    assert_eq!(f64s(&trajectory, "q")[3], 0.0);
    let mut bytes = Vec::new();
    write(&request, Format::Json, &mut bytes, &AtomicBool::new(false)).unwrap();
    let json: serde_json::Value = serde_json::from_slice(&bytes).unwrap();
    assert_eq!(json["not_finite"]["first"], serde_json::json!([1, 2]));
    assert_eq!((&json["count"], &json["columns"][0]), (&3.into(), &"trajectory".into()));
}

#[test]
fn what_no_ensemble_can_do_is_refused_before_any_work() {
    let base = request("oscillator", Method::Rk4, 0.1, 10);
    let of = |ensemble: EnsembleOptions, float| {
        let request = Request { float, ensemble: Some(ensemble), ..base.clone() };
        simulate(&request).unwrap_err().to_string()
    };
    let (f64, f16) = (FloatType::F64, FloatType::F16);
    for (ensemble, float, told) in [
        (EnsembleOptions { count: 0, ..COPIES }, f64, "`count` is 0, but it must be at least 1"),
        (EnsembleOptions { count: 1 << 40, ..COPIES }, f64, "GB of memory are needed"),
        (EnsembleOptions { count: 2, spread: f64::INFINITY, ..COPIES }, f64, "`spread` is inf"),
        (
            EnsembleOptions { count: 2, spread: 1e300, ..COPIES },
            FloatType::F32,
            "`spread` is 1e300",
        ),
        (COPIES, f16, "`dtype` is f16, but it must be f64 or f32"),
    ] {
        let error = of(ensemble, float);
        assert!(error.contains(told), "{error}");
    }
}
