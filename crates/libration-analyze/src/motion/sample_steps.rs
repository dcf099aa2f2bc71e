//! The steps after which a motion is compared with the exact one.

/// The first steps, after each of which errors are taken: a motion that decays at once has its errors there.
const FIRST: u64 = 64;

/// The ratio of the numbers of later steps.
const RATIO: f64 = 1.05;

/// Number of samples that are spread over all steps.
const SPREAD: u64 = 512;

/// The golden ratio less one: samples at its multiples meet no oscillation at the same phase.
const GOLDEN: f64 = 0.618_033_988_749_895;

/// The most steps of which all are compared.
const ALL: u64 = 2048;

/// The numbers of the steps in ascending order: all of few, else the first ones, a geometric sequence, and numbers that are spread over all
/// of `steps`.
pub(super) fn sample_steps(steps: u64) -> Vec<u64> {
    if steps <= ALL {
        return (1..=steps).collect();
    }
    let mut numbers: Vec<u64> = (1..=steps.min(FIRST)).collect();
    let mut next = FIRST as f64;
    while next < steps as f64 {
        numbers.push(next as u64);
        next *= RATIO;
    }
    let part = steps as f64 / SPREAD as f64;
    let spread = |i: u64| (part * (i as f64 + (GOLDEN * i as f64).fract())) as u64;
    numbers.extend((0..SPREAD).map(spread).filter(|number| (1..=steps).contains(number)));
    numbers.push(steps);
    numbers.sort_unstable();
    numbers.dedup();
    numbers
}

/// The same with those nearest to the `knots` of an adaptive motion, times in s: where it moves fast, they are many.
pub(super) fn with_knots(numbers: &[u64], knots: &[f64], dt: f64) -> Vec<u64> {
    let last = numbers.last().copied().unwrap_or(0);
    let near = knots.iter().map(|time| (time / dt).round() as u64);
    let mut all: Vec<u64> =
        near.filter(|number| (1..=last).contains(number)).chain(numbers.iter().copied()).collect();
    all.sort_unstable();
    all.dedup();
    all
}
