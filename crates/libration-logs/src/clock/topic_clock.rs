//! The clock of a topic.

use serde::Serialize;

use super::{Drift, LawFit, Statistics};
use crate::{ClockChoice, Log, LogError};

/// What the time stamps of a topic say about its clock.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TopicClock {
    /// The topic.
    pub topic: String,
    /// The type of its messages.
    pub message_type: String,
    /// The clock.
    pub clock: &'static str,
    /// The number of messages.
    pub messages: usize,
    /// The number of messages without this clock.
    pub without_clock: usize,
    /// The number of stamps before the preceding one in the file.
    pub backward: usize,
    /// The largest step back in s.
    pub largest_step_back: f64,
    /// Messages per second.
    pub rate: f64,
    /// Statistics of the intervals between the sorted stamps.
    pub statistics: Statistics,
    /// The law of the intervals.
    pub law: LawFit,
    /// The law of the lateness behind a grid of deadlines; none unless neighbouring intervals show a grid.
    pub lateness: Option<LawFit>,
    /// The drift of the log clock against the header clock.
    pub log_against_header: Option<Drift>,
}

impl TopicClock {
    /// The clock of a topic.
    ///
    /// # Errors
    /// If there is no such topic or clock, or fewer than two stamps; or if the stamps of a table begin again or mostly have no order.
    pub fn of(log: &Log, topic: &str, clock: ClockChoice) -> Result<Self, LogError> {
        let exact = log.exact_stamps(topic, clock)?;
        let mut stamps: Vec<i64> = exact.iter().flatten().copied().collect();
        let back = |pair: &[i64]| (i128::from(pair[0]) - i128::from(pair[1])) as f64 / 1e9;
        let largest_step_back = stamps.windows(2).map(back).fold(0.0, f64::max);
        let backward = stamps.windows(2).filter(|pair| pair[1] < pair[0]).count();
        check_order(&stamps, topic, !log.is_bag())?;
        stamps.sort_unstable();
        let (&[first, ..], true) = (stamps.as_slice(), stamps.len() >= 2) else {
            let count = stamps.len();
            return Err(LogError::Damaged(format!(
                "the number of time stamps of `{topic}` is {count}; expected at least 2"
            )));
        };
        let since = |&x: &i64| (i128::from(x) - i128::from(first)) as f64 / 1e9;
        let seconds: Vec<f64> = stamps.iter().map(since).collect();
        let intervals: Vec<f64> = stamps
            .windows(2)
            .map(|pair| (i128::from(pair[1]) - i128::from(pair[0])) as f64 / 1e9)
            .collect();
        let statistics = Statistics::of(&seconds, None).with_resolution(log.resolution(topic));
        let is_even = statistics.equal_up_to.is_some();
        if statistics.mean <= 0.0 {
            return Err(LogError::Damaged(format!("all time stamps of `{topic}` are equal")));
        }
        let fits = |name: &str| name == topic || name.strip_prefix('/') == Some(topic);
        let info = log.topics().into_iter().find(|info| fits(&info.name));
        let has_header = info.as_ref().is_some_and(|i| i.clocks.contains(&ClockChoice::Header));
        let log_against_header = match has_header {
            true => Drift::between(
                &log.exact_stamps(topic, ClockChoice::Header)?,
                &log.exact_stamps(topic, ClockChoice::Log)?,
            ),
            false => None,
        };
        Ok(TopicClock {
            topic: topic.to_owned(),
            message_type: info.map_or_else(String::new, |info| info.message_type),
            clock: clock.name(),
            messages: exact.len(),
            without_clock: exact.iter().filter(|stamp| stamp.is_none()).count(),
            backward,
            largest_step_back,
            rate: 1.0 / statistics.mean,
            law: if is_even { LawFit::constant() } else { LawFit::of(&intervals) },
            lateness: match is_even {
                true => None,
                false => lateness(&seconds, &intervals).map(|late| LawFit::of(&late)),
            },
            statistics,
            log_against_header,
        })
    }
}

/// Largest share of stamps of a table that go back: in more, the column is no time.
const UNORDERED: f64 = 0.05;
/// Share of the range by which a stamp goes back if a record begins again.
const RESTART: f64 = 0.1;

/// Checks the order of stamps in a file. The messages of a bag may be in another order than their stamps.
fn check_order(stamps: &[i64], topic: &str, is_table: bool) -> Result<(), LogError> {
    let count = stamps.len();
    if !is_table || count < 3 {
        return Ok(());
    }
    let backward = stamps.windows(2).filter(|pair| pair[1] < pair[0]).count();
    if backward as f64 > UNORDERED * (count - 1) as f64 {
        return Err(LogError::Damaged(format!(
            "{backward} of {count} stamps of `{topic}` go back; expected a column of time; help: choose it with --time"
        )));
    }
    let range = stamps.iter().max().zip(stamps.iter().min());
    let range = range.map_or(0.0, |(&last, &first)| last as f64 - first as f64);
    let is_restart = |pair: &[i64]| pair[0] as f64 - pair[1] as f64 > RESTART * range;
    match stamps.windows(2).position(is_restart) {
        Some(at) if count >= 32 => Err(LogError::Damaged(format!(
            "the log begins again: stamp {} of `{topic}` goes back by {:.6} s; expected one record; help: split the file there",
            at + 2,
            (stamps[at] as f64 - stamps[at + 1] as f64) / 1e9
        ))),
        _ => Ok(()),
    }
}

/// Correlation of neighbouring intervals from which on wake-ups are late on their own, each on a grid: half way to −0.5.
const GRID: f64 = -0.25;

/// By how much each stamp is behind the line of least squares through all stamps over their number on the grid, which counts gaps; none
/// if neighbouring intervals show no grid.
fn lateness(stamps: &[f64], intervals: &[f64]) -> Option<Vec<f64>> {
    let mut sorted = intervals.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let median = sorted[sorted.len() / 2].max(f64::MIN_POSITIVE);
    let periods = |interval: f64| (interval / median).round().max(1.0);
    let deviation = |&interval: &f64| interval - periods(interval) * median;
    let deviations: Vec<f64> = intervals.iter().map(deviation).collect();
    if correlation(&deviations) > GRID {
        return None;
    }
    let mut numbers = numbers_on_grid(stamps, median);
    for _ in 0..REFINEMENTS {
        let (origin, period) = line(&numbers, stamps);
        if period <= 0.0 || !period.is_finite() {
            return None;
        }
        let refined: Vec<f64> = stamps.iter().map(|t| ((t - origin) / period).round()).collect();
        if refined == numbers {
            break;
        }
        numbers = refined;
    }
    let (origin, period) = line(&numbers, stamps);
    Some(numbers.iter().zip(stamps).map(|(n, t)| t - origin - period * n).collect())
}

/// Most steps of the numbering by a line.
const REFINEMENTS: usize = 20;
/// Shares of a deviation by which the grid that follows the stamps moves and changes its period.
const FOLLOW: [f64; 2] = [0.1, 0.003];

/// The number of each stamp on a grid that follows the stamps slowly, since rounded intervals would add up their errors.
fn numbers_on_grid(stamps: &[f64], period: f64) -> Vec<f64> {
    let (mut period, mut deadline, mut number) = (period, stamps[0], 0.0);
    let follow = |&stamp: &f64| {
        let step = ((stamp - deadline) / period).round();
        let late = stamp - deadline - step * period;
        deadline += step * period + FOLLOW[0] * late;
        period += FOLLOW[1] * late;
        number += step;
        number
    };
    stamps.iter().map(follow).collect()
}

/// The line of least squares through stamps over their numbers: its value at zero, and its slope.
fn line(numbers: &[f64], stamps: &[f64]) -> (f64, f64) {
    let (x, y) = (mean(numbers), mean(stamps));
    let square: f64 = numbers.iter().map(|n| (n - x).powi(2)).sum();
    let product: f64 = numbers.iter().zip(stamps).map(|(n, t)| (n - x) * (t - y)).sum();
    (y - product / square * x, product / square)
}

/// The correlation of neighbours; 0 of values that do not vary.
fn correlation(values: &[f64]) -> f64 {
    let mean = mean(values);
    let square: f64 = values.iter().map(|x| (x - mean).powi(2)).sum();
    let product: f64 = values.windows(2).map(|pair| (pair[0] - mean) * (pair[1] - mean)).sum();
    if square > 0.0 { product / square } else { 0.0 }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

#[cfg(test)]
mod tests {
    use libration::random::{Address, Purpose};

    use super::*;
    use crate::ReadOptions;
    use crate::clock::LawVerdict;

    #[test]
    fn a_column_without_order_and_a_log_that_begins_again_are_errors() {
        let error = |value: &dyn Fn(u64) -> u64| {
            let lines: Vec<_> = (0..200).map(|n| value(n).to_string()).collect();
            let text = format!("time_ms\n{}\n", lines.join("\n"));
            let log = Log::from_bytes(text.into_bytes(), &ReadOptions::default()).unwrap();
            TopicClock::of(&log, "time_ms", ClockChoice::Log).unwrap_err().to_string()
        };
        assert!(error(&|n| n * 7919 % 200).contains("help: choose it with --time"));
        assert!(error(&|n| n % 150).contains("the log begins again: stamp 151"));
    }

    #[test]
    fn late_wake_ups_on_a_grid_have_the_law_of_their_lateness() {
        let noise = |n: u64| {
            let address = Address { seed: 3, trajectory: 0, step: n, purpose: Purpose::StepTime };
            (50_000.0 * address.gaussian()[0]) as i64
        };
        // A deadline in a hundred is missed.
        let numbers = (0..4000_u64).filter(|n| n % 100 != 50);
        let stamps = numbers.map(|n| (1_000_000_000 + 1_000_000 * n as i64 + noise(n)).to_string());
        let text = format!("time_ns\n{}\n", stamps.collect::<Vec<_>>().join("\n"));
        let log = Log::from_bytes(text.into_bytes(), &ReadOptions::default()).unwrap();
        let clock = TopicClock::of(&log, "time_ns", ClockChoice::Log).unwrap();
        let lateness = clock.lateness.unwrap();
        assert_eq!(lateness.verdict, LawVerdict::Fits);
        assert_eq!(lateness.fits[0].name, "gaussian");
        assert_eq!(clock.statistics.gaps, 40);
        // A wake-up that is late by up to half a period does not shift the numbers of the others.
        let noise = |n: u64| {
            let address = Address { seed: 5, trajectory: 0, step: n, purpose: Purpose::StepTime };
            0.00025 * (0.5 * address.gaussian()[0]).tanh() - 0.0002 * address.gaussian()[1].cos()
        };
        let late: Vec<f64> = (0..4000).map(noise).collect();
        let stamps: Vec<f64> =
            late.iter().zip(0..).map(|(late, n)| 1e-3 * f64::from(n) + late).collect();
        let intervals: Vec<f64> = stamps.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let found = super::lateness(&stamps, &intervals).unwrap();
        let (a, b) = (mean(&found), mean(&late));
        let worst = found.iter().zip(&late).map(|(x, y)| (x - a - y + b).abs()).fold(0.0, f64::max);
        assert!(worst < 3e-5, "{worst}");
        // Intervals of a few lengths have none of the laws.
        assert_ne!(clock.law.verdict, LawVerdict::Fits);
    }
}
