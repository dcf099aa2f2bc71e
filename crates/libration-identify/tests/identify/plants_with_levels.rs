//! Plants that are not linear, and commands that repeat themselves.

use libration_identify::{Hold, Identification, Recording, Request, ResponseKind};
use libration_report::Outcome;

use crate::loops::{Draws, commands, identified, lag_response, quick};

/// A lag of 50 ms behind 33.4 ms of a command of which `acting` acts.
fn found(commands: &[f64], times: &[f64], acting: fn(f64) -> f64) -> Identification {
    let arrivals: Vec<(f64, f64)> =
        times.iter().zip(commands).map(|(t, u)| (t + 0.0334, acting(*u))).collect();
    let mut draws = Draws(71);
    let clean = lag_response(&arrivals, 0.05, 1.0, times);
    let responses: Vec<f64> = clean.iter().map(|y| y + 0.01 * draws.normal()).collect();
    let recording = Recording::new(times, commands, times, &responses).expect("valid");
    let request = Request {
        responses: vec![ResponseKind::Lag],
        holds: vec![Hold::Zero],
        arrivals: false,
        largest_dead_time: Some(0.6),
        ..quick()
    };
    identified(&recording, &request)
}

#[test]
fn a_plant_that_is_not_linear_has_no_intervals() {
    let (times, commands) = commands(500, 5, &mut Draws(73));
    let acting: [fn(f64) -> f64; 5] = [
        |u| u - u.clamp(-0.1, 0.1),
        |u| u.clamp(-0.6, 0.6),
        |u| u - 0.2 * u.powi(3),
        |u| u + 0.2 * u * u,
        |u| u.max(0.7 * u),
    ];
    for (i, acting) in acting.into_iter().enumerate() {
        let found = found(&commands, &times, acting);
        assert_eq!(found.verdict.outcome, Outcome::Fault, "{i}: {}", found.verdict);
        assert!(found.linearity.contradict(), "{i}: {:?}", found.linearity);
        assert!(found.parameters.iter().all(|parameter| parameter.interval.is_none()));
        assert!(found.delay_range.is_none());
    }
    let found = found(&commands, &times, |u| u);
    assert_eq!(found.verdict.outcome, Outcome::NoFault, "{}", found.verdict);
}

#[test]
fn a_command_that_repeats_itself_leaves_the_dead_time_unknown() {
    let times: Vec<f64> = (0..500).map(|i| f64::from(i) * 0.01).collect();
    // A saw, a square wave, and pulses, each with a period of 0.3 s: behind the first responses nothing tells periods apart.
    let shapes: [fn(usize) -> f64; 3] = [
        |i| i as f64 / 15.0,
        |i| if i < 15 { 1.0 } else { -1.0 },
        |i| if i < 5 { 1.0 } else { 0.0 },
    ];
    for (i, shape) in shapes.into_iter().enumerate() {
        let commands: Vec<f64> = (0..500).map(|k| shape(k % 30)).collect();
        let found = found(&commands, &times, |u| u);
        assert_eq!(found.verdict.outcome, Outcome::Unknown, "{i}: {}", found.verdict);
        let is_rival = |dead_time: &f64| {
            let apart = (dead_time - found.parameter("dead_time").unwrap().value).abs();
            (apart - 0.3).abs() < 1e-3
        };
        assert!(found.other_dead_times.iter().any(is_rival), "{i}: {}", found.verdict);
        assert!(!found.has_loop() && found.delay_range.is_none());
    }
}

/// Behind its start the response to a ramp is a ramp, whatever part of its lateness is dead time, lag or a constant load.
#[test]
fn a_ramp_leaves_the_dead_time_unknown() {
    let times: Vec<f64> = (0..400).map(|i| f64::from(i) * 0.01).collect();
    let commands: Vec<f64> = times.iter().map(|time| time / 4.0).collect();
    let found = found(&commands, &times, |u| u);
    assert_eq!(found.verdict.outcome, Outcome::Unknown, "{}", found.verdict);
    assert!(found.verdict.evidence.contains("do not determine the dead time"), "{}", found.verdict);
    assert!(!found.has_loop());
}

/// A smooth pulse shows the sum of dead time and lag, not which part is which.
#[test]
fn smooth_commands_leave_models_with_other_dead_times_and_the_verdict_unknown() {
    let times: Vec<f64> = (0..400).map(|i| f64::from(i) * 0.01).collect();
    let commands: Vec<f64> =
        times.iter().map(|time| 1.0 - (0.5 * core::f64::consts::PI * time).cos()).collect();
    let arrivals: Vec<(f64, f64)> =
        times.iter().zip(&commands).map(|(t, u)| (t + 0.0334, *u)).collect();
    let mut draws = Draws(72);
    let clean = lag_response(&arrivals, 0.05, 1.0, &times);
    let responses: Vec<f64> = clean.iter().map(|y| y + 0.01 * draws.normal()).collect();
    let recording = Recording::new(&times, &commands, &times, &responses).expect("valid");
    let found = identified(&recording, &quick());
    assert_eq!(found.verdict.outcome, Outcome::Unknown, "{}", found.answer);
}
