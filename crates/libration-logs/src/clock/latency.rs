//! Latencies from one topic to another.

use serde::Serialize;

use super::pairs::{Matched, by_header, by_order, by_row, seconds};
use super::statistics::{Quantile, quantiles_at};
use super::{Dependence, LawFit, LawVerdict, PhaseLag, TimeDependence, phase_lags, rate_of_phase};
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

/// Why latencies may not be those of a cause.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Doubt {
    /// All are 0: stamps of one topic are copied to the other.
    CopiedStamps,
    /// All are longer than the record of the earlier topic: the clocks of both are apart.
    ClocksApart,
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
    /// The median interval of the earlier topic in s, above which latencies are not visible; none if messages belong together.
    pub visible_up_to: Option<f64>,
    /// Whether the latencies reach this interval or are nearly uniform over it, so that the true ones may be longer.
    pub is_cut: bool,
    /// Why the latencies may not be those of a cause.
    pub doubt: Option<Doubt>,
    /// The mean in s.
    pub mean: f64,
    /// The standard deviation in s.
    pub deviation: f64,
    /// Quantiles in s.
    pub quantiles: Vec<Quantile>,
    /// Lower bounds of bins in s, and numbers of latencies. The last bin has all above it.
    pub histogram: Vec<(f64, usize)>,
    /// Whether the latencies depend on time.
    pub time_dependence: TimeDependence,
    /// The law of the latencies; none of those that depend on time.
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
        let latencies = matched.latencies();
        let Matched { pairs, unmatched, unanswered } = matched;
        if latencies.is_empty() {
            return Err(LogError::Damaged(format!("no message on `{to}` follows one on `{from}`")));
        }
        let count = latencies.len() as f64;
        let mean = latencies.iter().sum::<f64>() / count;
        let square = latencies.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / count;
        let time_dependence = TimeDependence::of(&pairs);
        let law = match time_dependence.dependence {
            Dependence::Changing => LawFit::without(LawVerdict::DependsOnTime),
            Dependence::Correlated => LawFit::without(LawVerdict::Correlated),
            Dependence::None | Dependence::TooFew => LawFit::of(&latencies),
        };
        let negative = latencies.iter().filter(|&&x| x < 0.0).count();
        if negative as f64 > REVERSED * count {
            return Err(LogError::Damaged(format!(
                "{negative} of {count} latencies from `{from}` to `{to}` are below zero; expected at most 5 %; help: swap --topic and --against"
            )));
        }
        let mut sorted = latencies;
        sorted.sort_unstable_by(f64::total_cmp);
        let visible_up_to = match matching {
            Matching::NearestPreceding => median_interval(&earlier),
            _ => None,
        };
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
            visible_up_to,
            doubt: doubt(&sorted, &earlier),
            is_cut: visible_up_to.is_some_and(|interval| is_cut(&sorted, interval)),
            mean,
            deviation: square.sqrt(),
            histogram: histogram(&sorted),
            time_dependence,
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

/// Intervals beyond which latencies are doubted.
const MOST_INTERVALS: f64 = 100.0;

fn doubt(sorted: &[f64], earlier: &[Option<i64>]) -> Option<Doubt> {
    let (first, last) = (*sorted.first()?, *sorted.last()?);
    if first == 0.0 && last == 0.0 {
        return Some(Doubt::CopiedStamps);
    }
    let stamps = || earlier.iter().flatten().copied();
    let span = seconds(stamps().min()?, stamps().max()?);
    let is_apart = first > span && first > MOST_INTERVALS * median_interval(earlier)?;
    is_apart.then_some(Doubt::ClocksApart)
}

/// The median interval between sorted stamps, in s.
fn median_interval(stamps: &[Option<i64>]) -> Option<f64> {
    let mut stamps: Vec<i64> = stamps.iter().flatten().copied().collect();
    stamps.sort_unstable();
    let mut intervals: Vec<f64> = stamps.windows(2).map(|pair| seconds(pair[0], pair[1])).collect();
    intervals.sort_unstable_by(f64::total_cmp);
    intervals.get(intervals.len() / 2).copied()
}

/// Whether sorted latencies reach an interval, or differ from uniform ones over it by less than 10 % of probability.
fn is_cut(sorted: &[f64], interval: f64) -> bool {
    let count = sorted.len() as f64;
    let reach = sorted[(sorted.len() - 1) * 99 / 100] >= 0.95 * interval;
    let distance = |(i, x): (usize, &f64)| (x / interval - (i as f64 + 0.5) / count).abs();
    reach || sorted.iter().enumerate().map(distance).fold(0.0, f64::max) < 0.1
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
    fn latencies_that_reach_the_interval_are_cut() {
        let spread =
            |width: f64| -> Vec<f64> { (0..100).map(|i| width * f64::from(i) / 100.0).collect() };
        assert!(is_cut(&spread(0.01), 0.01));
        assert!(!is_cut(&spread(0.004), 0.01));
        assert_eq!(median_interval(&[Some(0), Some(5_000_000), Some(9_000_000)]), Some(0.005));
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
    fn copied_stamps_and_clocks_that_are_apart_are_doubted() {
        let of = |late: i64| {
            let row = |n: i64| format!("{},{}\n", n * 10_000_000, n * 10_000_000 + late);
            let text = "start_ns,end_ns\n".to_owned() + &(0..200).map(row).collect::<String>();
            let log = Log::from_bytes(text.into(), &Default::default()).unwrap();
            Latency::between(&log, "start_ns", "end_ns", ClockChoice::Log).unwrap().doubt
        };
        assert_eq!(of(0), Some(Doubt::CopiedStamps));
        assert_eq!(of(1_000_000), None);
        assert_eq!(of(3_600_000_000_000), Some(Doubt::ClocksApart));
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
}
