//! Commands of controllers.

use libration::State;
use libration::control::controller::{Pid, PidGains, Saturated, StateFeedback};
use libration::control::{Controller, Feedback};
use libration::ensemble::{All, Execution, Loops, Setup};
use libration::integrator::Rk4;
use libration::system::{BaselineOnly, DampedOscillator};

const GAINS: PidGains<1> = PidGains {
    proportional: 2.0,
    integral: 1.0,
    derivative: 0.5,
    filter: 0.0,
    most: f64::INFINITY,
    tracking: 1.0,
    target: [1.0],
};

fn at(q: f64) -> State<f64, 1> {
    State { q: [q], v: [0.0] }
}

/// The commands for some positions, a tenth of a second apart.
fn commands(gains: PidGains<1>, positions: &[f64]) -> Vec<f64> {
    let pid = Pid::new(gains).unwrap();
    let mut memory = Controller::<f64, 1>::start(&pid, &at(positions[0]));
    positions.iter().map(|&q| pid.command(&mut memory, &at(q), 0.1)[0]).collect()
}

#[test]
fn the_three_terms_are_those_of_the_textbook() {
    // Error 1, then 0.5 after a move of 0.5 in 0.1 s.
    let [first, second] = commands(GAINS, &[0.0, 0.5])[..] else { panic!("two") };
    assert_eq!(first, 2.0);
    // 2·0.5, the integral of 1 over 0.1 s, and −0.5·0.5/0.1.
    assert!((second - (1.0 + 0.1 - 2.5)).abs() < 1e-15, "{second}");
    // A filter takes away the edge: K_d·0.5/(0.1 + 0.15).
    let filtered = commands(PidGains { filter: 0.15, ..GAINS }, &[0.0, 0.5]);
    assert!((filtered[1] - (1.0 + 0.1 - 1.0)).abs() < 1e-15);
}

#[test]
fn the_integral_does_not_wind_up_at_the_limit() {
    let held = vec![0.0; 200];
    let limited = PidGains { most: 1.5, ..GAINS };
    let command = |gains, after: f64| {
        let positions: Vec<f64> = held.iter().copied().chain([after, after]).collect();
        *commands(PidGains { derivative: 0.0, ..gains }, &positions).last().unwrap()
    };
    // 20 s at the limit, then on target: without a limit the integral is 20 and more.
    assert!(command(GAINS, 1.0) > 20.0);
    // With one it settles where wanted − 1.5 = K_i·error·tracking: at 0.5 in all.
    assert!((command(limited, 1.0) - 0.5).abs() < 0.1);
}

#[test]
fn a_pid_loop_comes_to_rest_on_its_target_in_spite_of_the_spring() {
    let pid = Pid::new(PidGains { filter: 0.02, ..GAINS }).unwrap();
    let setup = Setup::new(All(BaselineOnly(DampedOscillator { omega2: 2.0, gamma: 0.5 })), Rk4)
        .controller(pid);
    let mut all = Loops::new(setup, 0.01, 0, [0.0], &[at(0.0)], Execution::serial()).unwrap();
    all.advance(20_000).unwrap();
    // The slowest mode decays within seconds: after 200 s only rounding is left.
    assert!((all.state(0).unwrap().q[0] - 1.0).abs() < 1e-12);
    let command = all.command(0).unwrap()[0];
    assert!((command - 2.0).abs() < 1e-11, "{command}");
}

#[test]
fn an_actuator_does_not_do_more_than_it_can() {
    let feedback = StateFeedback::<1>::to_origin(Feedback { position: 10.0, velocity: 0.0 });
    let saturated = Saturated { controller: feedback, most: 2.0 };
    for (q, wanted) in [(0.1, -1.0), (1.0, -2.0), (-1.0, 2.0)] {
        assert_eq!(saturated.command(&mut [], &at(q), 0.1), [wanted]);
    }
}
