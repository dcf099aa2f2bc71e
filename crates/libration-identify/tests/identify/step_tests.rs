//! Step tests from rest, which many people record: their only change of the command is early.

use libration_identify::{
    Hold, Identification, NoiseKind, Recording, Request, ResponseKind, Start,
};
use libration_report::Outcome;

use crate::loops::{Draws, identified, lag_response, quick, value};

/// A step test of a lag, by its closed form.
struct StepTest {
    span: f64,
    interval: f64,
    /// Times and values of the command, the first at the beginning.
    command: Vec<(f64, f64)>,
    dead_time: f64,
    lag: f64,
    gain: f64,
    noise: f64,
    /// The response at the beginning, beyond that at rest.
    offset: f64,
    seed: u64,
}

/// A servo: 2 s at 100 Hz, a step at 0.1 s.
const SERVO: StepTest = StepTest {
    span: 2.0,
    interval: 0.01,
    command: Vec::new(),
    dead_time: 0.03,
    lag: 0.05,
    gain: 1.0,
    noise: 0.002,
    offset: 0.0,
    seed: 1,
};

impl StepTest {
    /// Times, commands and responses.
    fn columns(&self) -> [Vec<f64>; 3] {
        let count = (self.span / self.interval).round() as u32;
        let times: Vec<f64> = (0..count).map(|i| f64::from(i) * self.interval).collect();
        let at = |time: f64| {
            let set = self.command.iter().rev().find(|(from, _)| *from <= time + 1e-9);
            set.map_or(self.command[0].1, |(_, command)| *command)
        };
        let commands: Vec<f64> = times.iter().map(|&time| at(time)).collect();
        // From rest under the first command: the closed form begins at zero, to which the response at rest is added.
        let first = self.command[0].1;
        let arrivals: Vec<(f64, f64)> =
            times.iter().zip(&commands).map(|(t, u)| (t + self.dead_time, u - first)).collect();
        let mut draws = Draws(self.seed);
        let moved = lag_response(&arrivals, self.lag, self.gain, &times);
        let response = |(y, t): (&f64, &f64)| {
            let decay = self.offset * (-t / self.lag).exp();
            y + self.gain * first + decay + self.noise * draws.normal()
        };
        let responses = moved.iter().zip(&times).map(response).collect();
        [times, commands, responses]
    }

    fn recording(&self) -> Recording {
        let [times, commands, responses] = self.columns();
        Recording::new(&times, &commands, &times, &responses).expect("a valid recording")
    }
}

/// All candidates, as by default.
fn all() -> Request {
    Request { largest_dead_time: None, ..quick() }
}

/// The lag alone.
fn lag_alone() -> Request {
    Request {
        responses: vec![ResponseKind::Lag],
        noises: vec![NoiseKind::White],
        holds: vec![Hold::Zero],
        ..all()
    }
}

/// Asserts that the interval of each number contains it, widened by its own width: the truth is then beyond it in one of 10⁸ recordings.
fn assert_near(found: &Identification, truths: &[(&str, f64)]) {
    for &(key, truth) in truths {
        let parameter = found.parameter(key).unwrap_or_else(|| panic!("{key}: {}", found.answer));
        let interval = parameter.interval.expect("an interval");
        let high = interval.high.expect("an upper end");
        let width = high - interval.low;
        let is_inside = (interval.low - width..=high + width).contains(&truth);
        assert!(is_inside, "{key} {truth}: {}", found.answer);
        // A step test knows its numbers: to a third.
        assert!(width < 0.3 * truth.abs(), "{key} {truth}: {}", found.answer);
    }
}

#[test]
fn a_step_within_the_largest_dead_time_is_not_lost() {
    let test = StepTest { command: vec![(0.0, 0.0), (0.1, 1.0)], ..SERVO };
    let found = identified(&test.recording(), &all());
    assert_eq!((found.response, found.start), ("lag", Start::Rest), "{}", found.answer);
    assert_near(&found, &[("dead_time", 0.03), ("lag", 0.05), ("gain", 1.0)]);
    assert_eq!(found.verdict.outcome, Outcome::NoFault, "{}", found.verdict);
    assert!(found.answer.contains("starts from rest"), "{}", found.answer);
    assert_eq!(found.responses, 200);
}

#[test]
fn the_gain_of_a_slow_step_test_is_known_from_its_rest() {
    let test = StepTest {
        span: 100.0,
        interval: 0.5,
        command: vec![(0.0, 0.0), (12.0, 1.0)],
        dead_time: 2.0,
        lag: 10.0,
        gain: 2.0,
        noise: 0.05,
        ..SERVO
    };
    let found = identified(&test.recording(), &all());
    assert_eq!(found.response, "lag", "{}", found.answer);
    assert_near(&found, &[("dead_time", 2.0), ("lag", 10.0), ("gain", 2.0)]);
    let gain = found.parameter("gain").and_then(|gain| gain.interval).expect("an interval");
    // The level before the step is known to 0.05/√28 of 28 responses, that behind the lag to 0.05/√130: together to 0.0104. An interval is
    // four of these wide, and the errors of the lag add little.
    assert!(gain.high.expect("an end") - gain.low < 0.06, "{gain:?}");
}

#[test]
fn a_step_in_the_first_row_is_one_from_the_command_before_the_log() {
    let test = StepTest { command: vec![(-1.0, 0.0), (0.0, 1.0)], ..SERVO };
    let [times, commands, responses] = test.columns();
    let error = Recording::new(&times, &commands, &times, &responses).expect_err("no change");
    assert!(error.to_string().contains("if another command acted before"), "{error}");
    let recording = Recording::behind(0.0, &times, &commands, &times, &responses).expect("valid");
    let found = identified(&recording, &lag_alone());
    assert_eq!(found.start, Start::Rest);
    assert_near(&found, &[("dead_time", 0.03), ("lag", 0.05), ("gain", 1.0)]);
    // In the second row no option is needed.
    let test = StepTest { command: vec![(0.0, 0.0), (0.01, 1.0)], seed: 3, ..SERVO };
    let found = identified(&test.recording(), &lag_alone());
    assert_near(&found, &[("dead_time", 0.03), ("lag", 0.05), ("gain", 1.0)]);
}

#[test]
fn other_step_tests_are_read_as_well() {
    let minute = |command| StepTest {
        span: 600.0,
        interval: 1.0,
        command,
        dead_time: 15.0,
        lag: 120.0,
        gain: 80.0,
        noise: 0.1,
        ..SERVO
    };
    // A pulse; a step of a negative gain between values that are not zero; a heater that is turned on, and off again.
    let tests = [
        StepTest { command: vec![(0.0, 0.0), (0.1, 1.0), (0.2, 0.0)], seed: 5, ..SERVO },
        StepTest { command: vec![(0.0, 5.0), (0.1, 6.0)], gain: -3.0, seed: 7, ..SERVO },
        StepTest { command: vec![(0.0, 1.0), (0.05, 0.0)], seed: 9, ..SERVO },
        minute(vec![(0.0, 0.0), (10.0, 1.0)]),
        minute(vec![(0.0, 0.0), (10.0, 1.0), (300.0, 0.0)]),
    ];
    for test in tests {
        let found = identified(&test.recording(), &lag_alone());
        assert_eq!(found.start, Start::Rest, "{}", found.answer);
        assert_near(
            &found,
            &[("dead_time", test.dead_time), ("lag", test.lag), ("gain", test.gain)],
        );
        assert_eq!(found.verdict.outcome, Outcome::NoFault, "{}", found.verdict);
    }
}

#[test]
fn the_integral_of_a_step_from_rest_has_its_rate() {
    // y = s − T (1 − e^(−s/T)) with s from the arrival on.
    let (dead_time, lag, gain) = (0.03, 0.05, 2.0);
    // A motor rests under a command of 4, against a load: only what is beyond it moves.
    let rest = 4.0;
    let mut draws = Draws(11);
    let times: Vec<f64> = (0..200).map(|i| f64::from(i) * 0.01).collect();
    let commands: Vec<f64> = times.iter().map(|&t| rest + f64::from(u8::from(t > 0.095))).collect();
    let response = |t: &f64| {
        let s = (t - 0.1 - dead_time).max(0.0);
        gain * (s - lag * (1.0 - (-s / lag).exp())) + 0.001 * draws.normal()
    };
    let responses: Vec<f64> = times.iter().map(response).collect();
    let recording = Recording::new(&times, &commands, &times, &responses).expect("valid");
    let request = Request { responses: vec![ResponseKind::IntegratedLag], ..lag_alone() };
    let found = identified(&recording, &request);
    assert_near(&found, &[("dead_time", dead_time), ("lag", lag), ("gain", gain)]);
    assert!((value(&found, "load") + gain * rest).abs() < 0.05, "{:?}", found.parameters);
    // Among the others it is not taken for a lag of hours.
    let found = identified(&recording, &Request { noises: vec![NoiseKind::White], ..all() });
    assert_eq!(found.response, "integrated-lag", "{}", found.answer);
}

#[test]
fn a_loop_that_moves_before_its_step_is_not_taken_for_one_at_rest() {
    let moving = StepTest {
        command: vec![(0.0, 0.0), (0.1, 1.0)],
        lag: 0.3,
        offset: 3.0,
        seed: 13,
        ..SERVO
    };
    let found = identified(&moving.recording(), &lag_alone());
    assert_eq!(found.start, Start::Held, "{}", found.answer);
    assert_near(&found, &[("dead_time", 0.03), ("lag", 0.3), ("gain", 1.0)]);
    // Who says that it rests is contradicted.
    let forced = Request { start: Some(Start::Rest), ..lag_alone() };
    let found = identified(&moving.recording(), &forced);
    assert_eq!(found.verdict.outcome, Outcome::Fault, "{}", found.verdict);
}

#[test]
fn intervals_of_step_tests_contain_the_truth() {
    let mut counts = [0; 3];
    for seed in 0..20 {
        let command = vec![(0.0, 0.0), (0.1, 1.0)];
        let test = StepTest { command, seed: 100 + seed, dead_time: 0.0334, ..SERVO };
        let found = identified(&test.recording(), &lag_alone());
        for (i, (key, truth)) in
            [("dead_time", 0.0334), ("lag", 0.05), ("gain", 1.0)].into_iter().enumerate()
        {
            let interval = found.parameter(key).and_then(|parameter| parameter.interval);
            counts[i] += usize::from(interval.is_some_and(|interval| interval.contains(truth)));
        }
    }
    // Of 20 intervals at 95 % at least 15 contain the truth with a probability of 0.9997 (binomial law). The example `coverage` tries hundreds.
    assert!(counts.iter().all(|&count| count >= 15), "{counts:?}");
}

#[test]
fn that_nothing_depends_on_a_command_needs_evidence() {
    let mut draws = Draws(17);
    let mut noise = |count: usize| -> Vec<f64> { (0..count).map(|_| draws.normal()).collect() };
    let (times, commands) = crate::loops::commands(1200, 5, &mut Draws(19));
    let outcome = |times: &[f64], commands: &[f64], responses: &[f64], request: &Request| {
        let recording = Recording::new(times, commands, times, responses).expect("valid");
        let found = identified(&recording, request);
        assert!(!found.depends_on_command && found.delay_range.is_none(), "{}", found.answer);
        (found.verdict.outcome, found.answer)
    };
    // 1200 responses exclude that a random command explains a tenth of their variance.
    let (found, answer) = outcome(&times, &commands, &noise(1200), &lag_alone());
    assert_eq!(found, Outcome::Fault, "{answer}");
    assert!(answer.contains("nearly all of it comes from elsewhere"), "{answer}");
    // 60 do not.
    let (found, answer) = outcome(&times[..60], &commands[..60], &noise(60), &lag_alone());
    assert_eq!(found, Outcome::Unknown, "{answer}");
    assert!(answer.contains("unknown: the command may explain"), "{answer}");
    // Nor do any that do not show the changes: before the used responses, or at the end.
    for (at, start) in [(10, Some(Start::Unknown)), (1150, None)] {
        let step: Vec<f64> = (0..1200).map(|i| f64::from(u8::from(i >= at))).collect();
        let request = Request { start, ..lag_alone() };
        let (found, answer) = outcome(&times, &step, &noise(1200), &request);
        assert_eq!(found, Outcome::Unknown, "{answer}");
        assert!(answer.contains("0 of 1 changes"), "{answer}");
    }
    // A step in the middle is evidence.
    let step: Vec<f64> = (0..1200).map(|i| f64::from(u8::from(i >= 500))).collect();
    let (found, answer) = outcome(&times, &step, &noise(1200), &lag_alone());
    assert_eq!(found, Outcome::Fault, "{answer}");
}

#[test]
fn responses_that_hardly_follow_a_step_have_no_verdict() {
    // The step arrives 20 ms before the end.
    let test = StepTest { command: vec![(0.0, 0.0), (1.95, 1.0)], seed: 23, ..SERVO };
    let found = identified(&test.recording(), &all());
    assert_eq!(found.verdict.outcome, Outcome::Unknown, "{}", found.verdict);
    assert!(value(&found, "gain").is_finite());
}

#[test]
fn the_only_step_of_a_long_log_is_among_the_responses_that_are_used() {
    let test = StepTest {
        span: 12.0,
        interval: 0.001,
        command: vec![(0.0, 0.0), (6.0, 1.0)],
        seed: 29,
        ..SERVO
    };
    let request = Request { largest_dead_time: Some(0.1), ..lag_alone() };
    let found = identified(&test.recording(), &request);
    assert_near(&found, &[("dead_time", 0.03), ("lag", 0.05), ("gain", 1.0)]);
}
