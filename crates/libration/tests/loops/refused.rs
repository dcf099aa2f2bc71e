//! What is refused, in words that name it.

use libration::State;
use libration::analysis::Latency;
use libration::control::clock::{Rates, Recorded};
use libration::control::controller::{Pid, PidGains};
use libration::control::delay::{Latencies, Order, Packets, RecordedLatencies, Schedule};
use libration::control::{Clock, Delay};
use libration::ensemble::{All, Execution, Loops, Setup};
use libration::integrator::Rk4;
use libration::system::Oscillator;

fn refused<C: Clock<f64>, L: Delay<f64>>(clock: C, delay: L, dt: f64, steps: u64) -> String {
    let setup = Setup::new(All(Oscillator { omega2: 1.0 }), Rk4)
        .controller(libration::control::controller::StateFeedback::to_origin(Default::default()))
        .clock(clock)
        .delay(delay);
    let starts = [State { q: [1.0], v: [0.0] }; 2];
    let made = Loops::new(setup, dt, 0, [0.0], &starts, Execution::serial());
    made.and_then(|mut loops| loops.advance(steps)).unwrap_err().to_string()
}

#[test]
fn records_are_never_made_longer_and_lists_are_of_the_right_length() {
    let every = Schedule::EVERY_STEP;
    let fixed = libration::control::clock::Fixed;
    assert_eq!(
        refused(Recorded::once(&[1.0, 1.0]), every, 0.1, 3),
        "the record of a clock or a delay has 2 steps; 3 are asked for"
    );
    let latencies = RecordedLatencies::new(&[0.0, 2.0]).unwrap();
    assert_eq!(
        refused(fixed, latencies, 0.1, 5),
        "the record of a clock or a delay has 2 steps; 5 are asked for"
    );
    assert_eq!(
        refused(Rates(&[1.0]), every, 0.1, 1),
        "there are 1 rates of clocks for 2 trajectories; there must be one each, or one for all"
    );
    let one = [Latency::of_steps(1.0).unwrap()];
    assert_eq!(
        refused(fixed, Latencies(&one), 0.1, 1),
        "there are 1 latencies for 2 trajectories; there must be one each, or one for all"
    );
    for dt in [0.0, -0.1, f64::NAN, f64::INFINITY] {
        let error = refused(fixed, every, dt, 1);
        assert_eq!(error, format!("the time step is {dt} s; it must be above 0"));
    }
}

#[test]
fn a_clock_does_not_go_back() {
    let error = |stamps: &[f64]| Recorded::steps_between(stamps).unwrap_err().to_string();
    assert_eq!(
        error(&[0.0, 2.0, 1.0]),
        "time stamp 2 is 1 s, before the 2 s of the one in front of it"
    );
    assert_eq!(error(&[0.0, f64::NAN]), "time stamp 1 is NaN: it must be a number");
    assert_eq!(error(&[1.0]), "1 time stamps: there must be at least 2");
    assert_eq!(error(&[]), "0 time stamps: there must be at least 2");
    assert_eq!(error(&[1.0, 1.0]), "the mean step is 0 s: it must be above 0");
}

#[test]
fn numbers_that_are_no_delay_or_controller_are_named() {
    let packets = |p: &[f64]| Packets::new(p, Order::LastActs).unwrap_err().to_string();
    assert_eq!(
        packets(&[0.5, 0.6]),
        "the probabilities sum to 1.1; it must be at most 1, and the rest is lost"
    );
    assert_eq!(
        packets(&[0.5, -0.1]),
        "the probability of a latency of 1 steps is -0.1; it must be from 0 to 1"
    );
    assert_eq!(
        packets(&[]),
        "0 probabilities; there must be 1 to 16, for latencies of 0 steps and on"
    );
    let latency = RecordedLatencies::new(&[1.0, -1.0]).unwrap_err().to_string();
    assert_eq!(latency, "latency 1 is -1 steps; it must be at least 0 and at most 4096");
    let gains = PidGains {
        proportional: 1.0,
        integral: f64::NAN,
        derivative: 0.0,
        filter: 0.0,
        most: 1.0,
        tracking: 1.0,
        target: [0.0],
    };
    let pid = |gains| Pid::<1>::new(gains).unwrap_err().to_string();
    assert_eq!(pid(gains), "integral is NaN; it must be a number");
    assert_eq!(
        pid(PidGains { integral: 0.0, most: 0.0, ..gains }),
        "most is 0; it must be above 0"
    );
    let filter = PidGains { integral: 0.0, filter: -1.0, ..gains };
    assert_eq!(pid(filter), "filter is -1; it must be at least 0 s");
}
