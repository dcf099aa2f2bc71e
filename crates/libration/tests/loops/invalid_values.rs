//! Invalid values are rejected with the parameter's name.

use libration::State;
use libration::control::clock::{
    Correlated, Drifting, Fixed, Gaussian, Jittered, LateTicks, MissedTicks, RandomWalk, Rates,
    Recorded, Sinusoidal, Skewed, Uniform,
};
use libration::control::controller::{Pid, PidGains, Saturated, StateFeedback};
use libration::control::delay::{Latencies, Order, Packets, RecordedLatencies};
use libration::control::{Clock, Controller, Delay, Feedback, Jitter, Latency};
use libration::ensemble::{All, Execution, Loops, Setup};
use libration::integrator::{Rk4, VelocityVerlet};
use libration::system::{BaselineOnly, Oscillator};

use super::any_clock::AnyClock;
use super::any_delay::AnyDelay;
use super::clocks::free;

const STARTS: [State<f64, 1>; 2] = [State { q: [1.0], v: [0.0] }; 2];

/// What is said of a clock in so many steps of `dt` seconds.
fn of_clock_in(clock: impl Clock<f64>, dt: f64, steps: u64) -> String {
    let made = Loops::new(free(AnyClock(&clock)), dt, 0, [0.0], &STARTS, Execution::serial());
    made.and_then(|mut loops| loops.advance(steps)).unwrap_err().to_string()
}

/// What is said of a delay in so many steps.
fn of_delay(delay: impl Delay<f64>, steps: u64) -> String {
    let setup = Setup::new(All(BaselineOnly(Oscillator { omega2: 1.0 })), VelocityVerlet)
        .controller(StateFeedback::to_origin(Default::default()))
        .delay(delay);
    let made = Loops::new(setup, 0.1, 0, [0.0], &STARTS, Execution::serial());
    made.and_then(|mut loops| loops.advance(steps)).unwrap_err().to_string()
}

#[test]
fn records_are_never_made_longer_and_lists_are_of_the_right_length() {
    assert_eq!(
        of_clock_in(Recorded::once(&[1.0, 1.0]), 0.1, 3),
        "the record of a clock or a delay has 2 steps; the run requires 3"
    );
    assert_eq!(
        of_delay(AnyDelay::Recorded(RecordedLatencies::new(&[0.0, 2.0]).unwrap()), 5),
        "the record of a clock or a delay has 2 steps; the run requires 5"
    );
    assert_eq!(
        of_clock_in(Rates(&[1.0]), 0.1, 1),
        "there are 1 rates of clocks for 2 trajectories; there must be one each, or one for all"
    );
    let one = [Latency::of_steps(1.0).unwrap()];
    assert_eq!(
        of_delay(Latencies::of_commands(&one), 1),
        "there are 1 latencies for 2 trajectories; there must be one each, or one for all"
    );
    let two = [one[0]; 2];
    assert_eq!(
        of_delay(Latencies::of_commands(&two).with_observations(&one), 1),
        "the number of latencies of observations is 1; it must be that of the latencies of commands, or 0"
    );
    for dt in [0.0, -0.1, f64::NAN, f64::INFINITY] {
        let error = of_clock_in(Fixed, dt, 1);
        assert_eq!(
            error,
            format!(
                "the time step is {dt:?} s; it must be a finite number above 0, in the float type as well"
            )
        );
    }
}

#[test]
fn a_clock_does_not_go_back() {
    let error = |stamps: &[f64]| Recorded::steps_between(stamps).unwrap_err().to_string();
    assert_eq!(
        error(&[0.0, 2.0, 1.0]),
        "time stamp 3 is 1 s; it must be at least the 2 s of the preceding one, \
         counted from the first"
    );
    assert_eq!(error(&[0.0, f64::NAN]), "time stamp 2 is NaN; it must be a finite number");
    assert_eq!(error(&[1.0]), "the number of time stamps is 1; it must be at least 2");
    assert_eq!(error(&[]), "the number of time stamps is 0; it must be at least 2");
    assert_eq!(error(&[1.0, 1.0]), "the mean step is 0 s; it must be a finite number above 0");
}

#[test]
fn time_stamps_become_steps_of_a_positive_length() {
    assert_eq!(Recorded::steps_in(&[0.0, 0.5, 1.25], 0.25).unwrap(), [2.0, 3.0]);
    for dt in [0.0, -1.0, f64::NAN] {
        let told = Recorded::steps_in(&[0.0, 1.0], dt).unwrap_err().to_string();
        assert!(told.contains("above 0"), "{told}");
    }
}

/// What is said of a clock before any step.
fn of_clock(clock: impl Clock<f64>) -> String {
    of_clock_in(clock, 0.1, 0)
}

#[test]
fn numbers_that_are_no_clock_are_named() {
    let least =
        |name, value| format!("{name} is {value}; it must be a finite number of at least 0");
    for bad in [-1.0, f64::NAN, f64::INFINITY] {
        let jitter = least("the rms of step times", bad);
        assert_eq!(of_clock(Jittered(Gaussian(bad))), jitter);
        assert_eq!(of_clock(Jittered(Uniform(bad))), jitter);
        assert_eq!(of_clock((Fixed, Jittered(Jitter::Uniform(bad)))), jitter);
        assert_eq!(of_clock(Skewed(Jitter::Gaussian(bad))), least("the rms of clock rates", bad));
        assert_eq!(of_clock(Drifting(Jitter::Uniform(bad))), least("the rms of clock drifts", bad));
        assert_eq!(of_clock(RandomWalk { rms: bad }), least("the rms of changes of the rate", bad));
        assert_eq!(of_clock(Rates(&[1.0, bad])), least("clock rate 1", bad));
        assert_eq!(of_clock(Recorded::once(&[bad])), least("recorded step 0", bad));
        let waves = Sinusoidal { rms: bad, rate: 1.0, phase: 0.0 };
        assert_eq!(of_clock(waves), least("the rms of waving steps", bad));
        let correlated = Correlated { rms: bad, correlation: 0.5 };
        assert_eq!(of_clock(correlated), least("the rms of correlated steps", bad));
    }
    let waves = Sinusoidal { rms: 0.1, rate: f64::NAN, phase: 0.0 };
    assert_eq!(of_clock(waves), "the rate of waving steps is NaN; it must be a finite number");
    assert_eq!(
        of_clock(MissedTicks { probability: 1.0 }),
        "the probability of a missed tick is 1; it must be at least 0 and below 1"
    );
    assert_eq!(
        of_clock(LateTicks { probability: -0.1, by: 0.5 }),
        "the probability of a late tick is -0.1; it must be from 0 to 1"
    );
    assert_eq!(
        of_clock(LateTicks { probability: 0.5, by: 1.5 }),
        "the lateness of a tick is 1.5; it must be from 0 to 1"
    );
    assert_eq!(
        of_clock(Correlated { rms: 0.1, correlation: 1.5 }),
        "the correlation of steps is 1.5; it must be from -1 to 1"
    );
    assert_eq!(
        of_clock(Recorded::repeated(&[])),
        "the number of recorded steps is 0; it must be at least 1"
    );
}

/// What is said of a controller, in steps of 0.5 s, and of what acts before its first command.
fn of_controller(controller: impl Controller<f64, 1>, before: f64) -> String {
    let setup =
        Setup::new(All(BaselineOnly(Oscillator { omega2: 1.0 })), Rk4).controller(controller);
    let starts = [State { q: [1.0], v: [0.0] }];
    let made = Loops::new(setup, 0.5, 0, [before], &starts, Execution::serial());
    made.map(|_| ()).unwrap_err().to_string()
}

#[test]
fn numbers_that_are_no_controller_are_named_also_inside_another() {
    let gains = Feedback { position: f64::NAN, velocity: 1.0 };
    let bad = StateFeedback::to_origin(gains);
    let told = "the gain of the position is NaN; it must be a finite number";
    assert_eq!(of_controller(bad, 0.0), told);
    assert_eq!(of_controller(Saturated { controller: bad, most: 1.0 }, 0.0), told);
    let fine = StateFeedback { gains: Feedback::default(), target: [0.0] };
    assert_eq!(
        of_controller(Saturated { controller: fine, most: -1.0 }, 0.0),
        "the largest command is -1; it must be at least 0"
    );
    assert_eq!(
        of_controller(StateFeedback { target: [f64::INFINITY], ..fine }, 0.0),
        "the target is inf; it must be a finite number"
    );
    assert_eq!(
        of_controller(fine, f64::NAN),
        "the command before the first is NaN; it must be a finite number"
    );
    let setup = Setup::new(All(BaselineOnly(Oscillator { omega2: 1.0_f32 })), Rk4)
        .controller(StateFeedback::<1>::to_origin(Feedback { position: 1e39, velocity: 1.0 }));
    let starts = [State { q: [0.0_f32], v: [0.0] }];
    let short = Loops::new(setup, 0.5, 0, [0.0], &starts, Execution::serial()).map(|_| ());
    assert!(short.unwrap_err().to_string().contains("small enough for the float type"));
    let pid = PidGains {
        proportional: 1.0,
        integral: 1.0,
        derivative: 0.0,
        filter: 0.0,
        most: 1.0,
        tracking: 0.25,
        target: [0.0],
    };
    assert_eq!(
        of_controller(Pid::new(pid).unwrap(), 0.0),
        "the tracking time is 0.25; it must be more than half the sample time"
    );
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
    assert_eq!(pid(gains), "the integral gain is NaN; it must be a finite number");
    assert_eq!(
        pid(PidGains { integral: 0.0, most: 0.0, ..gains }),
        "the largest command is 0; it must be above 0"
    );
    let filter = PidGains { integral: 0.0, filter: -1.0, ..gains };
    assert_eq!(
        pid(filter),
        "the time of the filter is -1; it must be a finite number of at least 0"
    );
}
