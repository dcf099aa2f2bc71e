//! Invalid recordings and requests.

use std::sync::atomic::AtomicBool;

use libration_identify::{Recording, Request, identify};
use libration_work::{Silent, Work};

use crate::loops::{Draws, commands};

fn recording_error(times: &[f64], commands: &[f64], responses: &[f64]) -> String {
    let found = Recording::new(times, commands, times, responses);
    found.expect_err("an invalid recording").to_string()
}

#[test]
fn an_invalid_recording_is_refused_by_name() {
    let times: Vec<f64> = (0..50).map(f64::from).collect();
    let steps: Vec<f64> = (0..50).map(|i| f64::from(i % 7)).collect();
    let message = recording_error(&times, &steps[..49], &steps);
    assert_eq!(message, "50 times for 49 values of the command; expected one time for each value");
    let mut broken = steps.clone();
    broken[3] = f64::NAN;
    let message = recording_error(&times, &steps, &broken);
    assert_eq!(message, "value 3 of the response is NaN; expected a finite number");
    let mut back = times.clone();
    back[4] = 2.0;
    let message = recording_error(&back, &steps, &steps);
    assert!(message.contains("time 4 of the command is 2 s, after 3 s"), "{message}");
    assert!(recording_error(&times, &[1.0; 50], &steps).contains("the command is 1 throughout"));
    assert!(recording_error(&times, &steps, &[2.0; 50]).contains("the response is 2 throughout"));
    assert!(
        recording_error(&times[..9], &steps[..9], &steps[..9]).contains("expected at least 30")
    );
    assert!(recording_error(&[1.0; 50], &steps, &steps).contains("spread over time"));
}

#[test]
fn an_invalid_request_is_refused_by_name() {
    let (times, commands) = commands(100, 3, &mut Draws(1));
    let recording = Recording::new(&times, &commands, &times, &commands).unwrap();
    let stop = AtomicBool::new(false);
    let message = |request: Request| {
        identify(&recording, &request, &Work::new(&Silent, &stop)).unwrap_err().to_string()
    };
    let plain = Request::default;
    assert!(message(Request { dead_time: Some(-0.1), ..plain() }).contains("dead time is -0.1"));
    assert!(message(Request { lag: Some(f64::NAN), ..plain() }).contains("lag is NaN"));
    assert!(message(Request { gain: Some(0.0), ..plain() }).contains("gain is 0"));
    let long = Request { largest_dead_time: Some(0.9), ..plain() };
    assert!(message(long).contains("lower the largest dead time"));
    assert!(message(Request { bootstrap: 1_000_000, ..plain() }).contains("at most 10000"));
}
