//! Controllers that measure the periods against `tools/measured_clock_reference.py`, which was written from their definition alone.

use libration::analysis::LinearController;
use libration::control::controller::{Pid, PidGains};
use libration::linear::{ClockedController, DiscreteController, LinearPlant};
use serde_json::Value;

use super::linear_reference::{compare, matrix, number, read};

/// A PID controller of the only output, for a length of the last period.
fn pid(case: &Value) -> impl Fn(f64) -> DiscreteController + Send + Sync + 'static {
    let [proportional, integral, derivative, filter] =
        ["kp", "ki", "kd", "filter"].map(|name| number(&case[name]));
    let gains = PidGains {
        proportional,
        integral,
        derivative,
        filter,
        most: f64::INFINITY,
        tracking: 1.0,
        target: [0.0],
    };
    move |seconds| {
        let pid = Pid::<1>::new(gains).unwrap();
        let own = LinearController::of(&pid, seconds).unwrap().discrete();
        let (b, d) = (own.b.block((0, 0), (own.memory(), 1)), own.d.block((0, 0), (1, 1)));
        DiscreteController { b, d, ..own }
    }
}

#[test]
fn controllers_that_measure_time_have_the_growth_and_cost_of_a_program_from_the_definition() {
    let reference: Value =
        serde_json::from_str(include_str!("../reference/measured_clock.json")).unwrap();
    let cases = reference["cases"].as_array().unwrap();
    assert_eq!(cases.len(), 8);
    for (i, case) in cases.iter().enumerate() {
        let period = number(&case["period"]);
        let clocked = match &case["kp"] {
            Value::Null => {
                let of = |name: &str| matrix(&case[name], 0);
                let plant = LinearPlant::new(of("a"), of("b"), of("c"), of("d")).unwrap();
                let (gain, filter) = (of("gain"), of("estimator"));
                ClockedController::new(period, move |seconds| {
                    plant.timed_feedback(&gain, &filter, seconds)
                })
            }
            _ => ClockedController::new(period, pid(case)),
        };
        let (nominal, timing) = read(case, clocked.at(period));
        let measured = nominal.with_measured_clock(clocked).unwrap();
        compare(i, case, &measured, &timing);
        // The nominal clock is another loop.
        let other = nominal.growth(&timing).unwrap();
        assert!((other - number(&case["growth"])).abs() > 1e-7, "{i}: {other}");
    }
}
