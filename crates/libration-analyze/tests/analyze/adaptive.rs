//! Tests of adaptive steps.

use libration::Method;
use libration::equations::Dynamics;
use libration::system::{Kepler, Oscillator};
use libration_analyze::adaptive::{
    AdaptiveFailure, AdaptivePrograms, AdaptiveStepper, StepControl,
};

/// The pericentre of an ellipse with semi-major axis 1.
fn pericentre(e: f64) -> [f64; 4] {
    [1.0 - e, 0.0, 0.0, ((1.0 + e) / (1.0 - e)).sqrt()]
}

fn kepler() -> Dynamics {
    Dynamics::of::<2>(&Kepler { mu: 1.0 }, None)
}

fn energy([x, y, vx, vy]: [f64; 4]) -> f64 {
    0.5 * (vx * vx + vy * vy) - 1.0 / (x * x + y * y).sqrt()
}

fn state(stepper: &AdaptiveStepper<'_>) -> [f64; 4] {
    stepper.state().try_into().unwrap()
}

#[test]
fn a_step_is_as_long_as_the_local_time_scale() {
    let programs = AdaptivePrograms::new(&kepler(), Method::Leapfrog);
    let e = 0.9;
    for control in StepControl::ALL {
        let dt = 1e-5;
        let mut stepper = AdaptiveStepper::new(&programs, control, &pericentre(e), dt).unwrap();
        while stepper.time() < 1.0 {
            stepper.advance().unwrap();
        }
        let [x, y, ..] = state(&stepper);
        let expected = dt * ((x * x + y * y).sqrt() / (1.0 - e)).powf(1.5);
        let ratio = stepper.last_length() / expected;
        assert!((ratio - 1.0).abs() < 2e-3, "{} {ratio}", control.name());
    }
}

#[test]
fn the_frequency_of_an_oscillator_is_its_own_and_its_steps_are_equal() {
    let dynamics = Dynamics::of::<1>(&Oscillator { omega2: 9.0 }, None);
    let program = dynamics.fourth_power_of_frequency();
    let found: Vec<f64> = program.on::<f64>().run(&[0.3, 0.4]).collect();
    assert_eq!(found, [81.0, 0.0]);
    // The Frobenius norm of the stiffness of an orbit: eigenvalues 2 and −1 over r³; the rate of its square is −6 ṙ/r of itself.
    let program = kepler().fourth_power_of_frequency();
    let found: Vec<f64> = program.on::<f64>().run(&[1.2, 1.6, 0.3, 0.4]).collect();
    let expected = 5.0 / 64.0;
    assert!((found[0] / expected - 1.0).abs() < 1e-15);
    assert!((found[1] / (-1.5 * expected) - 1.0).abs() < 1e-15);
}

/// Changes of the energy over the first and the last tenth of `periods` periods, relative to the energy, by means over the samples.
fn drift(control: StepControl, e: f64, dt: f64, periods: f64) -> f64 {
    let programs = AdaptivePrograms::new(&kepler(), Method::VelocityVerlet);
    let mut stepper = AdaptiveStepper::new(&programs, control, &pericentre(e), dt).unwrap();
    let end = periods * std::f64::consts::TAU;
    let mut means = [(0.0, 0.0); 2];
    while stepper.time() < end {
        stepper.advance().unwrap();
        let part = stepper.time() / end;
        let place = if part < 0.1 { 0 } else { 1 };
        if !(0.1..=0.9).contains(&part) {
            // Weights as long as the steps: a mean over time.
            let weight = stepper.last_length();
            means[place].0 += weight * energy(state(&stepper));
            means[place].1 += weight;
        }
    }
    let [first, last] = means.map(|(sum, weight)| sum / weight);
    (last - first) / 0.5
}

#[test]
fn reversible_steps_keep_the_energy_where_naive_ones_drift() {
    // At equal steps.
    for (e, dt) in [(0.9, 0.003), (0.99, 0.0001)] {
        let naive = drift(StepControl::Naive, e, dt, 100.0);
        assert!(naive.abs() > 1e-2, "{e} {naive}");
        for control in [StepControl::Symmetric, StepControl::Integrating] {
            let bounded = drift(control, e, dt, 100.0);
            assert!(
                bounded.abs() < naive.abs() / 300.0,
                "{e} {} {bounded} {naive}",
                control.name()
            );
        }
    }
}

#[test]
fn a_motion_there_and_back_returns_to_rounding_and_on_a_grid_to_the_bits() {
    let programs = AdaptivePrograms::new(&kepler(), Method::Leapfrog);
    let start = pericentre(0.9);
    let back = |stepper: &mut AdaptiveStepper<'_>, steps: usize| {
        (0..steps).for_each(|_| stepper.advance().unwrap());
        stepper.reverse();
        (0..steps).for_each(|_| stepper.advance().unwrap());
        stepper.reverse();
        let pairs = stepper.state().iter().zip(&start);
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    let new = |control| AdaptiveStepper::new(&programs, control, &start, 0.002).unwrap();
    // A thousand steps: some ten periods, whose phase errors grow as rounding does.
    for control in [StepControl::Symmetric, StepControl::Integrating] {
        let off = back(&mut new(control), 1000);
        assert!(off < 1e-9, "{} {off}", control.name());
    }
    let naive = back(&mut new(StepControl::Naive), 1000);
    assert!(naive > 1e-3, "{naive}");
    let mut on_grid = new(StepControl::Integrating).on_grid(&programs, -44).unwrap();
    let first = state(&on_grid);
    back(&mut on_grid, 100_000);
    assert_eq!(state(&on_grid), first);
    assert!(new(StepControl::Symmetric).on_grid(&programs, -44).is_none());
    let rk4 = AdaptivePrograms::new(&kepler(), Method::Rk4);
    let stepper = AdaptiveStepper::new(&rk4, StepControl::Integrating, &start, 0.002).unwrap();
    assert!(stepper.on_grid(&rk4, -44).is_none());
}

#[test]
fn free_motion_has_no_time_scale() {
    let free = Dynamics::of::<1>(&Oscillator { omega2: 0.0 }, None);
    let programs = AdaptivePrograms::new(&free, Method::Leapfrog);
    assert!(AdaptiveStepper::new(&programs, StepControl::Naive, &[1.0, 1.0], 0.1).is_none());
}

#[test]
fn motions_whose_frequency_vanishes_or_that_collide_end_by_name() {
    let advance = |dynamics: &Dynamics, start: &[f64], dt: f64| {
        let programs = AdaptivePrograms::new(dynamics, Method::Leapfrog);
        let mut stepper =
            AdaptiveStepper::new(&programs, StepControl::Integrating, start, dt).unwrap();
        (0..100_000).find_map(|_| stepper.advance().err())
    };
    // Over the top, cos q passes zero.
    let pendulum = Dynamics::of::<1>(&libration::system::Pendulum { omega2: 9.81 }, None);
    for speed in [4.8, 5.0, 5.4, 7.0] {
        let ended = advance(&pendulum, &[0.1, speed], 0.01);
        assert!(matches!(ended, Some(AdaptiveFailure::Density)), "{speed} {ended:?}");
    }
    let falling = advance(&kepler(), &[1.0, 0.0, 0.0, 0.0], 0.001);
    assert!(falling.is_some());
}
