//! The simulator: its clock, its count, its observers and overflow.

use libration::integrator::{ExplicitEuler, Leapfrog, Rk4, VelocityVerlet};
use libration::simulation::{EnergyDrift, Every, Sample, SimulationError, Simulator};
use libration::system::Oscillator;
use libration::{Integrator, State};

const OSCILLATOR: Oscillator<f64> = Oscillator { omega2: 1.0 };
const START: State<f64, 1> = State { q: [1.0], v: [0.0] };

#[test]
fn the_observed_drift_is_the_largest_one_with_its_step_and_its_range() {
    // At z = 1 Verlet repeats every six steps through q = ±1, ±½: the energy, half at the start,
    // falls by 3/16 of itself at q = ±½ and returns.
    let mut drift = EnergyDrift::new(OSCILLATOR, &START);
    Simulator::new(OSCILLATOR, VelocityVerlet, START, 1.0).unwrap().run(60, &mut drift).unwrap();
    assert_eq!((drift.initial(), drift.largest(), drift.at_step()), (0.5, 0.1875, 1));
    assert_eq!(drift.range(), (-0.1875, 0.0));
}

#[test]
fn a_drift_from_zero_energy_is_absolute() {
    let rest = State { q: [0.0], v: [0.0] };
    let drift = EnergyDrift::new(OSCILLATOR, &rest);
    assert_eq!(drift.of(&State { q: [2.0], v: [0.0] }), 2.0);
}

#[test]
fn the_clock_is_a_product_and_not_a_sum() {
    let mut simulator = Simulator::new(OSCILLATOR, Rk4, START, 0.1).unwrap();
    simulator.run(1_000_003, &mut ()).unwrap();
    let Sample { step, time, .. } = simulator.sample();
    assert_eq!((step, time), (1_000_003, 1_000_003.0 * 0.1));
}

#[test]
fn force_evaluations_are_counted_and_not_assumed() {
    fn count(integrator: impl Integrator) -> u64 {
        let mut simulator = Simulator::new(OSCILLATOR, integrator, START, 0.1).unwrap();
        simulator.run(10, &mut ()).unwrap();
        simulator.evaluations()
    }
    assert_eq!(count(ExplicitEuler), 10);
    assert_eq!(count(Leapfrog), 10);
    assert_eq!(count(VelocityVerlet), 20);
    assert_eq!(count(Rk4), 40);
    assert_eq!(count(libration::integrator::YOSHIDA4), 60);
}

#[test]
fn an_overflow_names_its_step_and_leaves_the_last_finite_state() {
    // v grows by √(1 + z²) = √101 a step: 308 digits are gone after 308·2/log₁₀ 101 = 307.3 steps.
    let mut seen = 0;
    let mut watch = |sample: &Sample<f64, 1>| seen = sample.step;
    let mut simulator = Simulator::new(OSCILLATOR, ExplicitEuler, START, 10.0).unwrap();
    let error = simulator.run(1_000, &mut watch).unwrap_err();
    let SimulationError::NotFinite { step, time } = error else { panic!("{error}") };
    assert!((300..=315).contains(&step), "{step}");
    assert_eq!(time, step as f64 * 10.0);
    assert_eq!((seen, simulator.sample().step), (step - 1, step - 1));
    assert!(simulator.sample().state.q[0].is_finite());
    assert!(error.to_string().contains(&format!("step {step}")));
}

#[test]
fn every_third_sample_begins_with_the_start() {
    let mut steps = Vec::new();
    let mut watch = Every { n: 3, observer: |s: &Sample<f64, 1>| steps.push(s.step) };
    Simulator::new(OSCILLATOR, Leapfrog, START, 0.1).unwrap().run(10, &mut watch).unwrap();
    assert_eq!(steps, [0, 3, 6, 9]);
}

#[test]
fn two_runs_one_after_the_other_are_one_run() {
    let whole = {
        let mut simulator = Simulator::new(OSCILLATOR, Rk4, START, 0.1).unwrap();
        simulator.run(10, &mut ()).unwrap();
        simulator.sample()
    };
    let mut steps = Vec::new();
    let mut watch = |s: &Sample<f64, 1>| steps.push(s.step);
    let mut simulator = Simulator::new(OSCILLATOR, Rk4, START, 0.1).unwrap();
    simulator.run(4, &mut watch).unwrap();
    simulator.run(6, &mut watch).unwrap();
    assert_eq!(simulator.sample(), whole);
    assert_eq!(steps, (0..=10).collect::<Vec<_>>());
}

#[test]
fn a_step_or_a_start_that_is_no_number_is_refused_before_any_work() {
    for dt in [0.0, -0.1, f64::NAN, f64::INFINITY] {
        let refused = Simulator::new(OSCILLATOR, Rk4, START, dt).unwrap_err();
        assert!(matches!(refused, SimulationError::TimeStep { .. }), "{dt}");
    }
    let lost = State { q: [1.0], v: [f64::NAN] };
    let refused = Simulator::new(OSCILLATOR, Rk4, lost, 0.1).unwrap_err();
    assert!(refused.to_string().contains("coordinate 1"), "{refused}");
}
