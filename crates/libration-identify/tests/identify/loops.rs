//! Loops by closed forms, and what is identified of them.

use std::sync::atomic::AtomicBool;

use libration_identify::{
    Hold, Identification, NoiseKind, Recording, Request, ResponseKind, identify,
};
use libration_work::{Silent, Work};

/// A linear congruential generator: uniform numbers between −1 and 1 whose sums of twelve are nearly normal.
pub(crate) struct Draws(pub(crate) u64);

impl Draws {
    pub(crate) fn uniform(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    pub(crate) fn normal(&mut self) -> f64 {
        // Twelve of variance 1/3 have variance 4.
        (0..12).map(|_| self.uniform()).sum::<f64>() / 2.0
    }
}

/// Random steps: `count` periods of 10 ms, held for `dwell`.
pub(crate) fn commands(count: usize, dwell: usize, draws: &mut Draws) -> (Vec<f64>, Vec<f64>) {
    let times: Vec<f64> = (0..count).map(|i| i as f64 * 0.01).collect();
    let mut commands = Vec::new();
    let mut command = 0.0;
    for i in 0..count {
        if i % dwell == 0 {
            command = draws.uniform();
        }
        commands.push(command);
    }
    (times, commands)
}

/// A lag by its closed form over arrivals in the order of time: no matrix, no filter, nothing of the crate.
pub(crate) fn lag_response(
    arrivals: &[(f64, f64)],
    lag: f64,
    gain: f64,
    samples: &[f64],
) -> Vec<f64> {
    let (mut state, mut now, mut command, mut next) = (0.0, 0.0, 0.0, 0);
    samples
        .iter()
        .map(|&sample| {
            while next < arrivals.len() && arrivals[next].0 <= sample {
                let (time, value) = arrivals[next];
                state = gain * command + (state - gain * command) * (-(time - now) / lag).exp();
                (now, command) = (time, value);
                next += 1;
            }
            state = gain * command + (state - gain * command) * (-(sample - now) / lag).exp();
            now = sample;
            state
        })
        .collect()
}

pub(crate) fn identified(recording: &Recording, request: &Request) -> Identification {
    let stop = AtomicBool::new(false);
    identify(recording, request, &Work::new(&Silent, &stop)).expect("a valid recording")
}

pub(crate) fn quick() -> Request {
    Request { bootstrap: 0, details: false, largest_dead_time: Some(0.2), ..Request::default() }
}

pub(crate) fn value(found: &Identification, key: &str) -> f64 {
    found.parameter(key).map_or(f64::NAN, |parameter| parameter.value)
}

#[test]
fn a_lag_behind_a_part_of_a_period_is_found_among_all_models() {
    let mut draws = Draws(5);
    let (times, commands) = commands(600, 5, &mut draws);
    let arrivals: Vec<(f64, f64)> =
        times.iter().zip(&commands).map(|(t, u)| (t + 0.0334, *u)).collect();
    // Samples between the commands, one in 9.1 ms.
    let samples: Vec<f64> = (0..650).map(|i| 0.0041 + 0.0091 * f64::from(i)).collect();
    let mut responses = lag_response(&arrivals, 0.05, 0.9, &samples);
    responses.iter_mut().for_each(|y| *y += 0.2 + 0.01 * draws.normal());
    let recording = Recording::new(&times, &commands, &samples, &responses).unwrap();
    let found = identified(&recording, &Request { bootstrap: 20, details: true, ..quick() });
    assert_eq!((found.response, found.hold, found.noise), ("lag", Hold::Zero, NoiseKind::White));
    for (key, truth) in [("dead_time", 0.0334), ("lag", 0.05), ("latency", 0.0834), ("gain", 0.9)] {
        let parameter = found.parameter(key).unwrap();
        let error = parameter.standard_error.unwrap();
        // Four standard errors: one of 4 numbers is beyond in one run of 4000.
        assert!((parameter.value - truth).abs() < 4.0 * error, "{key}: {parameter:?}");
        assert!(error < 0.02 * truth, "{key}: {parameter:?}");
    }
    // The noise: its standard deviation is known to 1/√(2n) = 2.3 %.
    assert!((value(&found, "noise_std") / 0.01 - 1.0).abs() < 0.1);
    assert!(!found.is_contradicted, "{:?}", found.residuals);
    // 20 repetitions know a standard deviation to 16 %: four of these.
    for row in &found.bootstrap {
        assert!((row.ratio.unwrap() - 1.0).abs() < 0.65, "{row:?}");
    }
}

#[test]
fn exact_responses_are_identified_to_their_rounding() {
    let mut draws = Draws(7);
    let (times, commands) = commands(400, 7, &mut draws);
    let arrivals: Vec<(f64, f64)> =
        times.iter().zip(&commands).map(|(t, u)| (t + 0.0272, *u)).collect();
    let responses = lag_response(&arrivals, 0.031, 1.0, &times);
    let recording = Recording::new(&times, &commands, &times, &responses).unwrap();
    let request = Request {
        responses: vec![ResponseKind::Lag],
        noises: vec![NoiseKind::White],
        holds: vec![Hold::Zero],
        ..quick()
    };
    let found = identified(&recording, &request);
    // Without noise the search ends where its simplex is small: 1e-5 of its scales of some milliseconds.
    for (key, truth) in [("dead_time", 0.0272), ("lag", 0.031), ("gain", 1.0)] {
        assert!((value(&found, key) / truth - 1.0).abs() < 1e-4, "{key}: {}", value(&found, key));
    }
}

#[test]
fn a_response_of_second_order_is_found_among_all_models() {
    // ÿ = ω²(u − y) − 2ζωẏ between arrivals, by sine and cosine.
    let (omega, zeta, dead_time) = (25.0_f64, 0.4_f64, 0.021);
    let damped = omega * (1.0 - zeta * zeta).sqrt();
    let mut draws = Draws(11);
    let (times, commands) = commands(500, 10, &mut draws);
    let (mut state, mut now, mut command, mut next) = ([0.0, 0.0], 0.0, 0.0, 0);
    let moved = |state: [f64; 2], command: f64, h: f64| {
        let [x, v] = [state[0] - command, state[1]];
        let (sine, cosine) = (damped * h).sin_cos();
        let decay = (-zeta * omega * h).exp();
        let b = (v + zeta * omega * x) / damped;
        let y = decay * (x * cosine + b * sine);
        let rate = decay * (b * damped * cosine - x * damped * sine) - zeta * omega * y;
        [command + y, rate]
    };
    let responses: Vec<f64> = times
        .iter()
        .map(|&sample| {
            while next < times.len() && times[next] + dead_time <= sample {
                state = moved(state, command, times[next] + dead_time - now);
                (now, command) = (times[next] + dead_time, commands[next]);
                next += 1;
            }
            state = moved(state, command, sample - now);
            now = sample;
            state[0] + 0.01 * draws.normal()
        })
        .collect();
    let recording = Recording::new(&times, &commands, &times, &responses).unwrap();
    let found = identified(&recording, &quick());
    assert_eq!(found.response, "second-order", "{}", found.answer);
    for (key, truth) in
        [("dead_time", dead_time), ("time_constant", 1.0 / omega), ("damping_ratio", zeta)]
    {
        let parameter = found.parameter(key).unwrap();
        let error = parameter.standard_error.unwrap();
        assert!((parameter.value - truth).abs() < 4.0 * error, "{key}: {parameter:?}");
    }
}

#[test]
fn a_dead_time_alone_is_known_to_the_interval_of_samples() {
    let mut draws = Draws(13);
    let (times, commands) = commands(600, 3, &mut draws);
    // A command that arrives 33 ms late shows first in the sample 40 ms after it.
    let mut responses: Vec<f64> =
        (0..times.len()).map(|i| if i < 4 { 0.0 } else { commands[i - 4] }).collect();
    responses.iter_mut().for_each(|y| *y += 0.02 * draws.normal());
    let recording = Recording::new(&times, &commands, &times, &responses).unwrap();
    let found = identified(&recording, &quick());
    assert_eq!(found.response, "delay", "{}", found.answer);
    let interval = found.parameter("dead_time").unwrap().interval.unwrap();
    // Its ends are those of the plateau, found by halving to a thousandth.
    assert!((interval.low - 0.03).abs() < 1e-4, "{interval:?}");
    assert!((interval.high.unwrap() - 0.04).abs() < 1e-4, "{interval:?}");
}

#[test]
fn a_log_from_inside_a_closed_loop_gives_the_same_numbers_and_says_so() {
    let (dead_time, lag, gain) = (0.0234, 0.06, 1.2);
    let mut draws = Draws(17);
    let (times, references) = commands(900, 12, &mut draws);
    let (mut state, mut commands, mut responses) = (0.0_f64, Vec::<f64>::new(), Vec::new());
    for (i, reference) in references.iter().enumerate() {
        // From the last sample to this one: two commands act, the later from 3.4 ms after the last sample on.
        let at = |back: usize| if i >= back { commands[i - back] } else { 0.0 };
        for (command, h) in [(at(4), 0.0034_f64), (at(3), 0.0066)] {
            if i > 0 {
                state = gain * command + (state - gain * command) * (-h / lag).exp();
            }
        }
        let measured = state + 0.02 * draws.normal();
        responses.push(measured);
        commands.push(reference + 1.5 * (reference - measured));
    }
    let recording = Recording::new(&times, &commands, &times, &responses).unwrap();
    let found = identified(&recording, &quick());
    assert_eq!(found.response, "lag", "{}", found.answer);
    for (key, truth) in [("dead_time", dead_time), ("lag", lag), ("gain", gain)] {
        let parameter = found.parameter(key).unwrap();
        let error = parameter.standard_error.unwrap();
        assert!((parameter.value - truth).abs() < 4.0 * error, "{key}: {parameter:?}");
    }
    assert!(
        found.warnings.iter().any(|warning| warning.contains("closed loop")),
        "{:?}",
        found.warnings
    );
}
