//! Latencies from one topic to another.

use std::collections::{HashMap, HashSet};

use serde::Serialize;

use super::statistics::{Quantile, quantiles_at};
use super::{LawFit, PhaseLag, phase_lags, rate_of_phase};
use crate::{ClockChoice, Log, LogError};

/// How messages are matched.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Matching {
    /// By equal header stamps.
    HeaderStamps,
    /// By the row of a table.
    Row,
    /// With the nearest preceding message.
    NearestPreceding,
}

/// The latency from the messages of one topic to those of another.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Latency {
    /// The earlier topic.
    pub from: String,
    /// The later topic.
    pub to: String,
    /// How messages are matched.
    pub matching: Matching,
    /// The clock that measures the latency.
    pub clock: &'static str,
    /// Number of latencies.
    pub count: usize,
    /// Number of messages of the later topic without a match.
    pub unmatched: usize,
    /// Number of messages of the earlier topic that no message of the later one answers.
    pub unanswered: usize,
    /// Number of latencies below zero.
    pub negative: usize,
    /// The mean in s.
    pub mean: f64,
    /// The standard deviation in s.
    pub deviation: f64,
    /// Quantiles in s.
    pub quantiles: Vec<Quantile>,
    /// Lower bounds of bins in s, and numbers of latencies. The last bin has all above it.
    pub histogram: Vec<(f64, usize)>,
    /// The law of the latencies.
    pub law: LawFit,
    /// Phase lags of the median.
    pub phase_of_median: Vec<PhaseLag>,
    /// Phase lags of the 99 % quantile.
    pub phase_of_99_percent: Vec<PhaseLag>,
    /// The bandwidth in Hz at which the 99 % quantile costs 10° of phase.
    pub bandwidth_at_10_degrees: Option<f64>,
}

/// Shares of the quantiles.
const PARTS: [f64; 6] = [0.0, 0.5, 0.9, 0.95, 0.99, 1.0];
/// Largest share of latencies below zero: more come from topics in the wrong order.
const REVERSED: f64 = 0.05;
/// Bins of the histogram.
const BINS: usize = 20;

impl Latency {
    /// The latency from a topic to another of a log, by the log clock or the publish clock.
    ///
    /// Time stamps in a row of a table belong together. Messages with equal header stamps belong together, if stamps are mostly unique
    /// and at least half of the later topic's messages have such a match. Else each belongs to the nearest preceding message.
    ///
    /// # Errors
    /// If there is no such topic or clock, if nothing matches, if both topics are the same, or if more than 5 % of the latencies are below
    /// zero.
    pub fn between(log: &Log, from: &str, to: &str, clock: ClockChoice) -> Result<Self, LogError> {
        if from.trim_start_matches('/') == to.trim_start_matches('/') {
            return Err(LogError::Damaged(format!(
                "both topics are `{from}`; expected a later topic than that of --topic"
            )));
        }
        let [earlier, later] = [log.exact_stamps(from, clock)?, log.exact_stamps(to, clock)?];
        let headers = if clock == ClockChoice::Header {
            // Equal header stamps would be latencies of zero.
            None
        } else {
            let [a, b] = [from, to].map(|topic| log.exact_stamps(topic, ClockChoice::Header).ok());
            a.zip(b)
        };
        let by_headers = headers.and_then(|(a, b)| by_header(&earlier, &a, &later, &b));
        let (matching, matched) = match by_headers {
            _ if !log.is_bag() => (Matching::Row, by_row(&earlier, &later)),
            Some(matched) => (Matching::HeaderStamps, matched),
            None => (Matching::NearestPreceding, by_order(&earlier, &later)),
        };
        let Matched { latencies, unmatched, unanswered } = matched;
        if latencies.is_empty() {
            return Err(LogError::Damaged(format!("no message on `{to}` follows one on `{from}`")));
        }
        let count = latencies.len() as f64;
        let mean = latencies.iter().sum::<f64>() / count;
        let square = latencies.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / count;
        let law = LawFit::of(&latencies);
        let negative = latencies.iter().filter(|&&x| x < 0.0).count();
        if negative as f64 > REVERSED * count {
            return Err(LogError::Damaged(format!(
                "{negative} of {count} latencies from `{from}` to `{to}` are below zero; expected at most 5 %; help: swap --topic and --against"
            )));
        }
        let mut sorted = latencies;
        sorted.sort_unstable_by(f64::total_cmp);
        let quantiles = quantiles_at(&PARTS, &sorted);
        let of = |part: f64| quantiles.iter().find(|q| q.part == part).map_or(0.0, |q| q.value);
        Ok(Latency {
            from: from.to_owned(),
            to: to.to_owned(),
            matching,
            clock: clock.name(),
            count: sorted.len(),
            unmatched,
            unanswered,
            negative,
            mean,
            deviation: square.sqrt(),
            histogram: histogram(&sorted),
            law,
            phase_of_median: phase_lags(of(0.5)),
            phase_of_99_percent: phase_lags(of(0.99)),
            bandwidth_at_10_degrees: rate_of_phase(of(0.99), 10.0),
            quantiles,
        })
    }

    /// A quantile in s.
    pub fn quantile(&self, part: f64) -> f64 {
        self.quantiles.iter().find(|q| q.part == part).map_or(self.mean, |q| q.value)
    }
}

struct Matched {
    /// In s, in file order of the later messages.
    latencies: Vec<f64>,
    unmatched: usize,
    unanswered: usize,
}

/// Least share of different stamps among the header stamps of a topic for which equal stamps show a cause.
const UNIQUE: f64 = 0.8;

/// Latencies between equal header stamps, each from the latest earlier message with the stamp; none if fewer than half of the later
/// messages have one, or if messages mostly repeat stamps.
fn by_header(
    earlier: &[Option<i64>],
    earlier_headers: &[Option<i64>],
    later: &[Option<i64>],
    later_headers: &[Option<i64>],
) -> Option<Matched> {
    if ![earlier_headers, later_headers].into_iter().all(is_mostly_unique) {
        return None;
    }
    let mut times: HashMap<i64, Vec<(i64, bool)>> = HashMap::new();
    for (time, header) in earlier.iter().zip(earlier_headers) {
        if let (Some(time), Some(header)) = (time, header) {
            times.entry(*header).or_default().push((*time, false));
        }
    }
    times.values_mut().for_each(|own| own.sort_unstable());
    let mut latencies = Vec::new();
    for (time, header) in later.iter().zip(later_headers) {
        let (Some(time), Some(header)) = (time, header) else { continue };
        let Some(own) = times.get_mut(header) else { continue };
        let before = own.partition_point(|(from, _)| from <= time).saturating_sub(1);
        if let Some((from, answered)) = own.get_mut(before) {
            *answered = true;
            latencies.push(seconds(*from, *time));
        }
    }
    let unmatched = later.len() - latencies.len();
    let unanswered = times.values().flatten().filter(|(_, answered)| !answered).count();
    (latencies.len() >= unmatched).then_some(Matched { latencies, unmatched, unanswered })
}

/// Whether most header stamps occur once.
fn is_mostly_unique(headers: &[Option<i64>]) -> bool {
    let different: HashSet<i64> = headers.iter().flatten().copied().collect();
    different.len() as f64 >= UNIQUE * headers.iter().flatten().count() as f64
}

/// Latencies within a row.
fn by_row(earlier: &[Option<i64>], later: &[Option<i64>]) -> Matched {
    let pairs = || earlier.iter().zip(later);
    let latencies: Vec<f64> = pairs().filter_map(|(a, b)| Some(seconds((*a)?, (*b)?))).collect();
    let unmatched = later.iter().flatten().count() - latencies.len();
    let unanswered = earlier.iter().flatten().count() - latencies.len();
    Matched { latencies, unmatched, unanswered }
}

/// Latencies from the nearest preceding message.
fn by_order(earlier: &[Option<i64>], later: &[Option<i64>]) -> Matched {
    let mut earlier: Vec<i64> = earlier.iter().flatten().copied().collect();
    earlier.sort_unstable();
    let mut answered = vec![false; earlier.len()];
    let mut latencies = Vec::new();
    for &time in later.iter().flatten() {
        let before = earlier.partition_point(|&own| own <= time);
        if let Some(i) = before.checked_sub(1) {
            answered[i] = true;
            latencies.push(seconds(earlier[i], time));
        }
    }
    let unmatched = later.len() - latencies.len();
    let unanswered = answered.iter().filter(|answered| !**answered).count();
    Matched { latencies, unmatched, unanswered }
}

fn seconds(from: i64, to: i64) -> f64 {
    (i128::from(to) - i128::from(from)) as f64 / 1e9
}

/// Counts in bins up to the 99 % quantile.
fn histogram(sorted: &[f64]) -> Vec<(f64, usize)> {
    let (low, high) = (sorted[0], sorted[(sorted.len() - 1) * 99 / 100]);
    if low >= high {
        return vec![(low, sorted.len())];
    }
    let width = (high - low) / (BINS - 1) as f64;
    let mut bins: Vec<(f64, usize)> = (0..BINS).map(|i| (low + i as f64 * width, 0)).collect();
    for x in sorted {
        bins[(((x - low) / width) as usize).min(BINS - 1)].1 += 1;
    }
    bins
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_are_matched_with_the_nearest_that_precedes() {
        let stamps = |all: &[i64]| all.iter().map(|&x| Some(x)).collect::<Vec<_>>();
        let found = by_order(&stamps(&[10, 30, 20]), &stamps(&[5, 12, 25, 26]));
        assert_eq!(found.latencies, [2e-9, 5e-9, 6e-9]);
        assert_eq!((found.unmatched, found.unanswered), (1, 1));
    }

    #[test]
    fn stamps_in_a_row_belong_together() {
        let text = "start,end\n1700000000000000000,1700000000000400000\n1700000000010000000,\n,1700000000020500000\n";
        let log = Log::from_bytes(text.into(), &Default::default()).unwrap();
        let found = Latency::between(&log, "start", "end", ClockChoice::Log).unwrap();
        assert_eq!((found.matching, found.count, found.mean), (Matching::Row, 1, 0.0004));
        assert_eq!((found.unmatched, found.unanswered), (1, 1));
    }

    #[test]
    fn topics_in_the_wrong_order_are_an_error() {
        let text = "start,end\n1700000000000000000,1700000000000400000\n1700000000010000000,1700000000010400000\n";
        let log = Log::from_bytes(text.into(), &Default::default()).unwrap();
        let error = |from: &str, to: &str| {
            Latency::between(&log, from, to, ClockChoice::Log).unwrap_err().to_string()
        };
        assert!(error("end", "start").contains("swap --topic and --against"));
        assert!(error("end", "end").contains("both topics are `end`"));
    }

    #[test]
    fn equal_header_stamps_belong_together() {
        let stamps = |all: &[i64]| all.iter().map(|&x| Some(x)).collect::<Vec<_>>();
        let (earlier, later) = (stamps(&[10, 20, 30]), stamps(&[35, 36, 37]));
        let found = by_header(&earlier, &stamps(&[1, 2, 3]), &later, &stamps(&[1, 3, 9])).unwrap();
        assert_eq!(found.latencies, [25e-9, 6e-9]);
        assert_eq!((found.unmatched, found.unanswered), (1, 1));
        assert!(by_header(&earlier, &stamps(&[1, 2, 3]), &later, &stamps(&[7, 8, 9])).is_none());
        // Stamps that are held show no cause.
        assert!(by_header(&earlier, &stamps(&[1, 2, 3]), &later, &stamps(&[1, 1, 1])).is_none());
        // The latest earlier message of two with a stamp.
        let (earlier, headers) = (stamps(&[10, 20, 30, 40, 50, 60]), [1, 2, 3, 4, 5, 5]);
        let later = stamps(&[55, 65]);
        let found = by_header(&earlier, &stamps(&headers), &later, &stamps(&[5, 6])).unwrap();
        assert_eq!(found.latencies, [5e-9]);
    }
}
