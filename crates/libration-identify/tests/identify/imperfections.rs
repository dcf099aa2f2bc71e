//! Commands that are lost or late at random.

use libration_identify::{Hold, Identification, Interval, Recording, Request, ResponseKind};

use crate::loops::{Draws, commands, identified, lag_response, quick, value};

/// A loop whose commands arrive as `arrival` says; a command that arrives after a newer one is ignored.
fn recorded(seed: u64, arrival: impl Fn(&mut Draws) -> Option<f64>) -> Recording {
    held(750, 3, seed, arrival)
}

/// The same of this many commands, each of which is repeated `dwell` times.
fn held(
    count: usize,
    dwell: usize,
    seed: u64,
    arrival: impl Fn(&mut Draws) -> Option<f64>,
) -> Recording {
    let mut draws = Draws(seed);
    let (times, commands) = commands(count, dwell, &mut draws);
    let mut arrivals: Vec<(f64, usize)> = Vec::new();
    for (k, time) in times.iter().enumerate() {
        arrivals.extend(arrival(&mut draws).map(|late| (time + late, k)));
    }
    arrivals.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut newest = 0;
    arrivals.retain(|&(_, k)| {
        let is_new = k >= newest;
        newest = newest.max(k);
        is_new
    });
    let arrivals: Vec<(f64, f64)> = arrivals.iter().map(|&(t, k)| (t, commands[k])).collect();
    let samples: Vec<f64> = times.iter().map(|t| t + 0.0071).collect();
    let mut responses = lag_response(&arrivals, 0.04, 1.0, &samples);
    responses.iter_mut().for_each(|y| *y += 0.005 * draws.normal());
    Recording::new(&times, &commands, &samples, &responses).expect("a valid recording")
}

fn lag_only() -> Request {
    Request { responses: vec![ResponseKind::Lag], ..quick() }
}

#[test]
fn losses_are_found_and_counted() {
    let recording = recorded(21, |draws| (draws.uniform() > 2.0 * 0.15 - 1.0).then_some(0.0234));
    let found = identified(&recording, &lag_only());
    assert_eq!(found.arrivals, "loss", "{}", found.answer);
    // Of 250 changes: 0.15 ± √(0.15·0.85/250) = 0.023; four of these.
    assert!((value(&found, "loss") - 0.15).abs() < 0.09, "{}", found.answer);
    assert!((value(&found, "dead_time") - 0.0234).abs() < 2e-4, "{}", found.answer);
    assert!(!found.is_contradicted, "{:?}", found.residuals);
}

#[test]
fn numbers_of_commands_that_are_lost_and_never_repeated_have_intervals() {
    let recording = held(300, 1, 22, |draws| (draws.uniform() > 2.0 * 0.1 - 1.0).then_some(0.0234));
    let found = identified(&recording, &lag_only());
    // A command that arrives more than a period late finds a newer one, and is lost too.
    let share = if found.arrivals == "loss" { "loss" } else { "second_share" };
    for (key, truth) in [("dead_time", 0.0234), ("lag", 0.04), ("gain", 1.0), (share, 0.1)] {
        let parameter = found.parameter(key).expect("a parameter");
        let interval = parameter.interval.expect("an interval");
        let width = interval.high.expect("an upper end") - interval.low;
        // A 95 % interval is four standard errors wide: the truth is within another four.
        let wide = Interval { low: interval.low - width, high: interval.high.map(|x| x + width) };
        assert!(wide.contains(truth) && width < truth, "{key}: {parameter:?}");
    }
    assert!(found.delay_range.is_some_and(|[low, high]| low < high), "{found:?}");
}

#[test]
fn jitter_of_the_dead_time_is_found_and_measured() {
    let recording = recorded(23, |draws| Some(0.0234 + 0.0015 * draws.normal()));
    let found = identified(&recording, &lag_only());
    assert_eq!(found.arrivals, "jitter", "{}", found.answer);
    // Of 250 changes 1.5 ms ± 1.5/√500 = 0.067 ms, and as much again for the filter's merging of hypotheses; four of these.
    assert!((value(&found, "jitter") - 0.0015).abs() < 4e-4, "{}", found.answer);
    assert!((value(&found, "dead_time") - 0.0234).abs() < 5e-4, "{}", found.answer);
}

#[test]
fn two_dead_times_are_told_apart_if_the_later_one_is_within_a_period() {
    let recording =
        recorded(29, |draws| Some(if draws.uniform() < -0.2 { 0.0294 } else { 0.0214 }));
    let found = identified(&recording, &lag_only());
    assert_eq!(found.arrivals, "two-delays", "{}", found.answer);
    assert!((value(&found, "dead_time") - 0.0214).abs() < 2e-4, "{}", found.answer);
    assert!((value(&found, "second_dead_time") - 0.0294).abs() < 3e-4, "{}", found.answer);
    // 0.4 ± 0.031; four of these.
    assert!((value(&found, "second_share") - 0.4).abs() < 0.13, "{}", found.answer);
}

#[test]
fn a_response_that_leads_its_command_is_named() {
    let mut draws = Draws(31);
    let (times, commands) = commands(600, 3, &mut draws);
    // The command is logged 25 ms after it acts.
    let arrivals: Vec<(f64, f64)> =
        times.iter().zip(&commands).map(|(t, u)| (t - 0.025, *u)).collect();
    let mut responses = lag_response(&arrivals, 0.02, 1.0, &times);
    responses.iter_mut().for_each(|y| *y += 0.01 * draws.normal());
    let recording = Recording::new(&times, &commands, &times, &responses).expect("valid");
    let request = Request { arrivals: false, holds: vec![Hold::Zero], ..lag_only() };
    let found = identified(&recording, &request);
    let leads = |found: &Identification| {
        found.warnings.iter().any(|warning| warning.contains("leads the command by 25"))
    };
    assert!(leads(&found), "{:?}", found.warnings);
    // Without the error of the clock the dead time is zero, and nothing leads.
    let late: Vec<f64> = times.iter().map(|time| time + 0.025).collect();
    let recording = Recording::new(&times, &commands, &late, &responses).expect("valid");
    let found = identified(&recording, &request);
    assert!(!found.warnings.iter().any(|warning| warning.contains("leads")), "{found:?}");
}
