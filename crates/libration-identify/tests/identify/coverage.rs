//! How often intervals contain the truth.

use libration_identify::{Hold, NoiseKind, Recording, Request, ResponseKind};

use crate::loops::{Draws, commands, identified, lag_response, quick};

/// Identifies `count` loops, and returns how many intervals of dead time and lag contain the truth, and how many recordings contradict.
fn tried(
    count: u64,
    dead_time: f64,
    noise: NoiseKind,
    errors: impl Fn(&mut Draws, usize) -> Vec<f64>,
) -> [usize; 3] {
    let (times, commands) = commands(260, 4, &mut Draws(3));
    let arrivals: Vec<(f64, f64)> =
        times.iter().zip(&commands).map(|(t, u)| (t + dead_time, *u)).collect();
    let clean = lag_response(&arrivals, 0.05, 1.3, &times);
    let request = Request {
        responses: vec![ResponseKind::Lag],
        noises: vec![noise],
        holds: vec![Hold::Zero],
        largest_dead_time: Some(0.1),
        arrivals: false,
        ..quick()
    };
    let mut counts = [0; 3];
    for seed in 0..count {
        let mut draws = Draws(1000 + seed);
        let errors = errors(&mut draws, times.len());
        let responses: Vec<f64> = clean.iter().zip(errors).map(|(y, e)| y + e).collect();
        let recording =
            Recording::new(&times, &commands, &times, &responses).expect("a valid recording");
        let found = identified(&recording, &request);
        for (i, (key, truth)) in [("dead_time", dead_time), ("lag", 0.05)].into_iter().enumerate() {
            let interval = found.parameter(key).and_then(|found| found.likelihood_interval);
            counts[i] += usize::from(interval.is_some_and(|interval| interval.contains(truth)));
        }
        counts[2] += usize::from(found.is_contradicted);
    }
    counts
}

/// Of 40 intervals at 95 % at least 33 contain the truth with a probability of 0.9993 (binomial law). The example `coverage` tries thousands.
const LEAST_OF_40: usize = 33;

#[test]
fn intervals_under_white_noise_contain_the_truth_in_nineteen_of_twenty_loops() {
    // A whole number of periods, where the likelihood has a kink.
    for dead_time in [0.0334, 0.03] {
        let white = |draws: &mut Draws, n: usize| (0..n).map(|_| 0.05 * draws.normal()).collect();
        let [dead_times, lags, contradicted] = tried(40, dead_time, NoiseKind::White, white);
        assert!(dead_times >= LEAST_OF_40 && lags >= LEAST_OF_40, "{dead_times} {lags}");
        // Two tests at 0.001 each: more than 3 of 40 have a probability below 10⁻⁵.
        assert!(contradicted <= 3, "{contradicted}");
    }
}

/// Errors with an exponential correlation over four samples.
fn coloured(draws: &mut Draws, n: usize) -> Vec<f64> {
    let decay = (-0.25_f64).exp();
    let mut error = draws.normal();
    (0..n)
        .map(|_| {
            error = decay * error + (1.0 - decay * decay).sqrt() * draws.normal();
            0.05 * error + 0.03 * draws.normal()
        })
        .collect()
}

#[test]
fn intervals_under_coloured_noise_hold_if_the_model_has_it_and_a_white_model_is_contradicted() {
    let [dead_times, lags, _] = tried(30, 0.0334, NoiseKind::Coloured, coloured);
    // At least 24 of 30 with a probability of 0.9994.
    assert!(dead_times >= 24 && lags >= 24, "{dead_times} {lags}");
    let [_, lags, contradicted] = tried(30, 0.0334, NoiseKind::White, coloured);
    assert_eq!(contradicted, 30);
    // What the contradiction warns of: the interval of the lag is too narrow.
    assert!(lags < 24, "{lags}");
}
