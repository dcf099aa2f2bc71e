//! Searches with a bound, and searches that are stopped.

use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use libration_identify::{IdentifyError, Recording, Request, identify};
use libration_work::{Interrupted, Silent, Work};

use crate::loops::{Draws, identified, quick};

/// A rate loop as of a multicopter: commands from a feedback, an inertia behind a lag, stamps that are not regular.
fn flight(count: usize) -> Recording {
    let mut draws = Draws(47);
    let (fine, dead_time) = (1e-3, 25_usize);
    let mut stamps = vec![0.0];
    for _ in 1..count {
        let last = stamps[stamps.len() - 1];
        stamps.push(last + 0.02 + 0.006 * draws.uniform());
    }
    let steps = (stamps[count - 1] / fine) as usize + 2;
    let (mut rate, mut torque, mut integral, mut load, mut reference) = (0.0, 0.0, 0.0, 0.0, 0.0);
    let (mut commands, mut responses) = (Vec::with_capacity(steps), Vec::with_capacity(steps));
    for i in 0..steps {
        if i % 400 == 0 {
            reference = 0.5 * draws.uniform();
        }
        let late = if i >= dead_time { commands[i - dead_time] } else { 0.0 };
        load = 0.999 * load + 0.01 * draws.normal();
        torque += fine / 0.05 * (late - torque);
        rate += fine * (30.0 * torque - 1.5 * rate + load);
        let measured: f64 = rate + 0.02 * draws.normal();
        integral += 0.3 * fine * (reference - measured);
        commands.push(0.08 * (reference - measured) + integral);
        responses.push(measured);
    }
    let at = |values: &[f64]| -> Vec<f64> {
        stamps.iter().map(|stamp| values[(stamp / fine) as usize]).collect()
    };
    Recording::new(&stamps, &at(&commands), &stamps, &at(&responses)).expect("a valid recording")
}

#[test]
fn a_search_that_does_not_end_is_named_and_holds_no_other_answer() {
    let recording = flight(120);
    // The search of a response of second order takes 1300 evaluations for its starts alone, that of a dead time about 100.
    let request = Request { budget: Some(400), arrivals: false, ..quick() };
    let found = identified(&recording, &request);
    let missing = "second-order response with white noise (budget of 400 evaluations)";
    let names = &found.verdict.not_examined;
    assert!(names.iter().any(|name| name == missing), "{names:?}");
    assert_ne!(found.response, "second-order");
    // The same budget gives the same numbers on each machine.
    let again = identified(&recording, &request);
    assert_eq!((found.answer, found.verdict), (again.answer, again.verdict));
    let request = Request { responses: request.responses[2..3].to_vec(), ..request };
    let stop = AtomicBool::new(false);
    let error = identify(&recording, &request, &Work::new(&Silent, &stop)).expect_err("no model");
    assert_eq!(error, IdentifyError::Budget(400));
}

#[test]
fn a_search_hears_that_it_is_stopped() {
    let recording = flight(4000);
    let stop = AtomicBool::new(false);
    let (ended, stopped) = thread::scope(|scope| {
        let run = scope.spawn(|| {
            let found = identify(&recording, &Request::default(), &Work::new(&Silent, &stop));
            (found, Instant::now())
        });
        thread::sleep(Duration::from_millis(200));
        stop.store(true, Ordering::Relaxed);
        let stopped = Instant::now();
        (run.join().expect("no panic"), stopped)
    });
    let (found, end) = ended;
    assert_eq!(found.expect_err("stopped"), IdentifyError::Interrupted(Interrupted));
    // An evaluation takes some milliseconds; a machine with much else to do takes longer. It was minutes.
    assert!(end - stopped < Duration::from_secs(3), "{:?}", end - stopped);
}
