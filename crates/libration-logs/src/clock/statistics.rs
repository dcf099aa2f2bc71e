//! Statistics of clocks.

use serde::Serialize;

use super::Spectrum;

/// Statistics of the intervals between time stamps.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Statistics {
    /// Number of intervals.
    pub intervals: usize,
    /// The nominal interval, in s; the mean if it is unknown.
    pub period: f64,
    /// The mean interval, in s.
    pub mean: f64,
    /// The resolution of the time stamps in s, if all intervals are equal up to it; then there is no correlation and no spectrum.
    pub equal_up_to: Option<f64>,
    /// The rms of the deviations from the mean, over the mean: the rms of a law of jitter.
    pub jitter_rms: f64,
    /// Quantiles of the intervals, in s.
    pub lengths: Vec<Quantile>,
    /// Number of intervals longer than 1.5 periods.
    pub gaps: usize,
    /// Number of intervals of length zero.
    pub repeats: usize,
    /// Autocorrelation of the deviations at lags from 1 on.
    pub correlation: Vec<f64>,
    /// Spectrum of the deviations; none for few intervals.
    pub spectrum: Option<Spectrum>,
    /// Lateness of the wake-ups; none without deadlines.
    pub lateness: Option<Lateness>,
}

/// Lateness of wake-ups.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Lateness {
    /// Quantiles of the lateness, in s.
    pub quantiles: Vec<Quantile>,
    /// Number of wake-ups after the next deadline.
    pub overruns: usize,
    /// Number of wake-ups per octave of lateness, from one microsecond on.
    pub histogram: Vec<(f64, usize)>,
}

/// A quantile.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Quantile {
    /// The share of values up to this one, from 0 to 1.
    pub part: f64,
    /// The value, in s.
    pub value: f64,
}

/// Shares of the quantiles.
const PARTS: [f64; 7] = [0.0, 0.01, 0.5, 0.9, 0.99, 0.999, 1.0];

/// Largest lag of the autocorrelation.
const LAGS: usize = 8;

impl Statistics {
    /// Statistics of a loop whose wake-up `k` had its deadline `k` periods after the first, in ns.
    pub fn of_loop(times: &[u64], period: u64) -> Self {
        let seconds = |nanoseconds: u64| nanoseconds as f64 * 1e-9;
        let stamps: Vec<f64> = times.iter().map(|&time| seconds(time)).collect();
        let late: Vec<f64> =
            (0..).zip(times).map(|(k, &time)| seconds(time.saturating_sub(k * period))).collect();
        let period = seconds(period);
        Statistics { lateness: Some(Lateness::of(late, period)), ..Self::of(&stamps, Some(period)) }
    }

    /// Statistics of rising time stamps in s.
    pub fn of(stamps: &[f64], period: Option<f64>) -> Self {
        let lengths: Vec<f64> = stamps.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let count = lengths.len();
        let mean = lengths.iter().sum::<f64>() / count.max(1) as f64;
        let period = period.unwrap_or(mean);
        let deviations: Vec<f64> = lengths.iter().map(|length| length / mean - 1.0).collect();
        let variance = covariance(&deviations, 0);
        let correlation = (1..=LAGS.min(count / 4))
            .map(|lag| if variance > 0.0 { covariance(&deviations, lag) / variance } else { 0.0 })
            .collect();
        Statistics {
            intervals: count,
            period,
            mean,
            equal_up_to: None,
            jitter_rms: variance.sqrt(),
            gaps: lengths.iter().filter(|&&length| length > 1.5 * period).count(),
            repeats: lengths.iter().filter(|&&length| length == 0.0).count(),
            correlation,
            spectrum: Spectrum::of(&deviations, 1.0 / mean),
            lengths: quantiles(lengths),
            lateness: None,
        }
    }
}

/// Units of the last place by which the longest and the shortest of equal intervals differ.
const ROUNDING: f64 = 4.0;
/// The unit of stamps in files, in s, with a margin for the rounding of a difference.
const NANOSECOND: f64 = 1.001e-9;
/// Largest resolution over the mean interval at which intervals are called equal.
const FINE: f64 = 0.01;

impl Statistics {
    /// The statistics of stamps with this distance of neighbouring numbers of floating point, in s: the correlation and the spectrum
    /// of intervals that are equal up to rounding would be those of the rounding.
    pub fn with_resolution(self, spacing: f64) -> Self {
        let resolution = NANOSECOND + ROUNDING * spacing;
        let ends = self.lengths.first().zip(self.lengths.last());
        let is_even = ends.is_some_and(|(first, last)| last.value - first.value <= resolution);
        if self.intervals < 2 || !is_even || resolution > FINE * self.mean {
            return self;
        }
        let (correlation, spectrum) = (Vec::new(), None);
        Statistics { equal_up_to: Some(resolution), correlation, spectrum, ..self }
    }

    /// Whether 98 % of the intervals lie within 2.33 rms: half the width of a Gaussian law.
    pub fn heavy_tailed(&self) -> bool {
        let at = |part: f64| self.lengths.iter().find(|q| q.part == part).map(|q| q.value);
        let (Some(low), Some(high)) = (at(0.01), at(0.99)) else { return false };
        high - low < 2.33 * self.jitter_rms * self.mean
    }
}

/// The autocovariance at `lag`.
fn covariance(deviations: &[f64], lag: usize) -> f64 {
    let pairs = deviations.iter().zip(deviations.iter().skip(lag));
    pairs.map(|(a, b)| a * b).sum::<f64>() / deviations.len().max(1) as f64
}

/// Quantiles of numbers in any order.
fn quantiles(mut values: Vec<f64>) -> Vec<Quantile> {
    values.sort_unstable_by(f64::total_cmp);
    quantiles_at(&PARTS, &values)
}

/// Quantiles of sorted numbers.
pub(super) fn quantiles_at(parts: &[f64], sorted: &[f64]) -> Vec<Quantile> {
    let at = |part: f64| {
        let place = (part * sorted.len() as f64).ceil().max(1.0) as usize - 1;
        sorted.get(place).copied()
    };
    parts.iter().filter_map(|&part| Some(Quantile { part, value: at(part)? })).collect()
}

impl Lateness {
    fn of(late: Vec<f64>, period: f64) -> Self {
        const MICROSECOND: f64 = 1e-6;
        let place = |late: f64| (late / MICROSECOND).max(1.0).log2() as usize;
        let places = late.iter().map(|&late| place(late)).max().unwrap_or(0) + 1;
        let mut histogram: Vec<(f64, usize)> =
            (0..places).map(|i| (MICROSECOND * 2.0_f64.powi(i as i32), 0)).collect();
        for &late in &late {
            histogram[place(late)].1 += 1;
        }
        let overruns = late.iter().filter(|&&late| late >= period).count();
        Lateness { overruns, histogram, quantiles: quantiles(late) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_those_of_the_definitions() {
        // Intervals 1, 1, 3, 0, 1, 1, 1, 0 of a loop with a period of 1.
        let stamps = [0.0, 1.0, 2.0, 5.0, 5.0, 6.0, 7.0, 8.0, 8.0];
        let found = Statistics::of(&stamps, Some(1.0));
        assert_eq!((found.intervals, found.mean), (8, 1.0));
        assert_eq!((found.gaps, found.repeats), (1, 2));
        // Deviations 0, 0, 2, −1, 0, 0, 0, −1.
        assert_eq!(found.jitter_rms, (6.0_f64 / 8.0).sqrt());
        assert_eq!(found.correlation, [-2.0 / 6.0, 0.0]);
        let at = |part: f64| found.lengths.iter().find(|q| q.part == part).unwrap().value;
        assert_eq!([at(0.0), at(0.5), at(1.0)], [0.0, 1.0, 3.0]);
        assert_eq!(found.lateness, None);
    }

    #[test]
    fn intervals_that_rounding_makes_unequal_are_equal() {
        let even = |period: f64, start: f64| -> Statistics {
            let stamps: Vec<f64> = (0..1000).map(|n| start + period * f64::from(n)).collect();
            let last: f64 = stamps[999];
            Statistics::of(&stamps, None).with_resolution(last.next_up() - last)
        };
        for found in [even(0.01, 0.0), even(1.0 / 3.0, 0.0), even(0.003, 1.7e9)] {
            assert!(found.equal_up_to.is_some() && found.correlation.is_empty(), "{found:?}");
            assert_eq!(found.spectrum, None);
        }
        // Rounding to a tenth of the interval may hide anything.
        assert_eq!(even(1e-5, 1.7e9).equal_up_to, None);
        let late: Vec<f64> = (0..1000).map(|n| f64::from(n) + 1e-7 * f64::from(n % 2)).collect();
        assert_eq!(Statistics::of(&late, None).with_resolution(1e-13).equal_up_to, None);
    }

    #[test]
    fn lateness_is_counted_from_deadlines_on_a_grid() {
        let times = [3_000, 1_005_000, 2_000_000, 5_500_000, 5_501_000, 5_502_000];
        let found = Statistics::of_loop(&times, 1_000_000).lateness.unwrap();
        // 3, 5, 0, 2500, 1501 and 502 µs.
        assert_eq!(found.overruns, 2);
        assert_eq!(found.quantiles.last().unwrap().value, 2.5e-3);
        let counts: Vec<usize> = found.histogram.iter().map(|&(_, count)| count).collect();
        assert_eq!(counts, [1, 1, 1, 0, 0, 0, 0, 0, 1, 0, 1, 1]);
    }

    #[test]
    fn nothing_is_said_of_nothing() {
        let none = Statistics::of(&[1.0], None);
        assert_eq!((none.intervals, none.jitter_rms), (0, 0.0));
        assert!(none.lengths.is_empty() && none.correlation.is_empty());
    }
}
