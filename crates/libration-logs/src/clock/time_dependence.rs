//! Whether latencies depend on time: their law would then be that of one record.

use serde::Serialize;

use super::Drift;

/// How latencies depend on time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Dependence {
    /// Nothing contradicts that they are independent of each other and of time.
    None,
    /// Neighbours resemble each other, as under a load that lasts; their mean stays.
    Correlated,
    /// Their mean changes over the record, as with clocks that drift or were set.
    Changing,
    /// There are too few.
    TooFew,
}

/// Whether latencies depend on time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TimeDependence {
    /// How they depend on time.
    pub dependence: Dependence,
    /// Their line over time; none for few.
    pub trend: Option<Drift>,
    /// The correlation of neighbours.
    pub correlation: f64,
}

/// Fewest latencies.
const FEWEST: usize = 32;
/// Parts of a record whose means are compared, and fewest latencies of each.
const BLOCKS: usize = 20;
const FEWEST_OF_BLOCK: usize = 4;
/// Most lags of a correlation, and most latencies of which they are computed.
const LAGS: usize = 50;
const MOST: usize = 1 << 17;
/// The normal number above which another is with a probability of 10⁻⁴.
const NORMAL: f64 = 3.72;
/// Student's quantile at 10⁻⁴ over that at 5 %, with 19 degrees of freedom: half the width of an interval is of 5 %.
const TREND: f64 = 4.90 / 2.093;
/// Least rise of a line over the record, in standard deviations: that of 0.1 moves no probability by more than 2 %.
const LEAST_RISE: f64 = 0.1;
/// The largest ratio of the variance of means to that of latencies which only resemble their neighbours: that of Fisher's law with 19 and 60
/// degrees of freedom at 10⁻⁴.
const RATIO: f64 = 3.6;

impl TimeDependence {
    /// The dependence of latencies on time, each with the stamps between which it lies in ns, in any order.
    pub(super) fn of(pairs: &[(i64, i64)]) -> Self {
        let mut pairs = pairs.to_vec();
        pairs.sort_unstable();
        let values: Vec<f64> =
            pairs.iter().map(|&(from, to)| (i128::from(to) - i128::from(from)) as f64).collect();
        let (earlier, later): (Vec<_>, Vec<_>) =
            pairs.iter().map(|&(from, to)| (Some(from), Some(to))).unzip();
        let trend = Drift::between(&earlier, &later);
        let span = pairs
            .last()
            .zip(pairs.first())
            .map_or(0.0, |(last, first)| (i128::from(last.0) - i128::from(first.0)) as f64);
        let deviations = centred(&values);
        let variance = mean_square(&deviations);
        let correlations = correlations(&deviations[..deviations.len().min(MOST)]);
        let rises = trend.is_some_and(|trend| {
            let is_sure = trend.skew_ppm.abs() > TREND * trend.half_width_ppm;
            is_sure && 1e-6 * trend.skew_ppm.abs() * span > LEAST_RISE * variance.sqrt()
        });
        let dependence = match variance > 0.0 {
            _ if values.len() < FEWEST => Dependence::TooFew,
            false => Dependence::None,
            true if rises || means_change(&values) => Dependence::Changing,
            true if are_correlated(&correlations, deviations.len().min(MOST)) => {
                Dependence::Correlated
            }
            true => Dependence::None,
        };
        let correlation = correlations.first().copied().unwrap_or(0.0);
        TimeDependence { dependence, trend, correlation }
    }
}

fn centred(values: &[f64]) -> Vec<f64> {
    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
    values.iter().map(|x| x - mean).collect()
}

fn mean_square(values: &[f64]) -> f64 {
    values.iter().map(|x| x * x).sum::<f64>() / values.len().max(1) as f64
}

/// The correlations of deviations at lags from 1 on; zeros of deviations that are zero.
fn correlations(deviations: &[f64]) -> Vec<f64> {
    let square: f64 = deviations.iter().map(|x| x * x).sum();
    let product =
        |lag: usize| -> f64 { deviations.iter().zip(&deviations[lag..]).map(|(x, y)| x * y).sum() };
    let lags = 1..=LAGS.min(deviations.len() / 5);
    lags.map(|lag| if square > 0.0 { product(lag) / square } else { 0.0 }).collect()
}

/// Whether correlations are larger than those of independent numbers (G. M. Ljung and G. E. P. Box, Biometrika 65, 1978), with chi squared by
/// its third root (E. B. Wilson and M. M. Hilferty, Proceedings of the National Academy of Sciences 17, 1931).
fn are_correlated(correlations: &[f64], count: usize) -> bool {
    let n = count as f64;
    let parts = correlations.iter().zip(1..).map(|(r, lag)| r * r / (n - f64::from(lag)));
    let statistic = n * (n + 2.0) * parts.sum::<f64>();
    let freedom = correlations.len().max(1) as f64;
    let part = 2.0 / (9.0 * freedom);
    ((statistic / freedom).cbrt() - (1.0 - part)) / part.sqrt() > NORMAL
}

/// Whether the means of the blocks of a record differ by more than the correlation within blocks explains.
fn means_change(values: &[f64]) -> bool {
    let length = values.len() / BLOCKS;
    if length < FEWEST_OF_BLOCK {
        return false;
    }
    let blocks: Vec<&[f64]> = values.chunks_exact(length).take(BLOCKS).collect();
    let means: Vec<f64> =
        blocks.iter().map(|block| block.iter().sum::<f64>() / length as f64).collect();
    let freedom = (BLOCKS - 1) as f64;
    let between = mean_square(&centred(&means)) * BLOCKS as f64 / freedom;
    let inside: Vec<Vec<f64>> = blocks.iter().map(|block| centred(block)).collect();
    let product = |lag: usize| -> f64 {
        let of =
            |block: &Vec<f64>| block.iter().zip(&block[lag..]).map(|(x, y)| x * y).sum::<f64>();
        inside.iter().map(of).sum()
    };
    let square = product(0);
    let n = length as f64;
    // Numbers that resemble each other over τ of them count as one: the sum of correlations while they are positive.
    let longest = (length / 2).min(LAGS);
    let correlations = (1..=longest).map(|lag| product(lag) / square).take_while(|r| *r > 0.0);
    let tau = (1.0 + 2.0 * correlations.sum::<f64>()).min(0.5 * n);
    let variance = square / (BLOCKS as f64 * (n - tau));
    between > RATIO * variance * tau / n
}

#[cfg(test)]
mod tests {
    use libration::random::{Address, Purpose};

    use super::*;

    fn normal(seed: u64, n: u64) -> f64 {
        Address { seed, trajectory: 0, step: n, purpose: Purpose::StepTime }.gaussian()[0]
    }

    /// The dependence of 2000 latencies in µs, one in 10 ms.
    fn of(latency: impl FnMut(u64) -> f64) -> TimeDependence {
        let stamps = (0..2000_i64).map(|n| 10_000_000 * n);
        let latencies: Vec<f64> = (0..2000).map(latency).collect();
        let pairs: Vec<_> =
            stamps.zip(latencies).map(|(t, late)| (t, t + (1000.0 * late) as i64)).collect();
        TimeDependence::of(&pairs)
    }

    #[test]
    fn clocks_that_drift_are_set_beat_or_follow_the_temperature_have_latencies_that_change() {
        // 20 ppm are 0.2 µs in 10 ms; noise of 100 µs would hide it from the eye.
        for noise in [0.0, 100.0] {
            let drifting = of(|n| 1000.0 + 0.2 * n as f64 + noise * normal(1, n));
            assert_eq!(drifting.dependence, Dependence::Changing, "{drifting:?}");
            let trend = drifting.trend.unwrap();
            // The rounding to ns leaves 1 ns in 20 s.
            assert!((trend.skew_ppm - 20.0).abs() <= trend.half_width_ppm + 1e-3, "{trend:?}");
        }
        let set = of(|n| 1000.0 + if n > 900 { 50.0 } else { 0.0 } + 100.0 * normal(2, n));
        assert_eq!(set.dependence, Dependence::Changing, "{set:?}");
        let sine = of(|n| 1000.0 + 50.0 * (n as f64 / 200.0).sin() + 100.0 * normal(3, n));
        assert_eq!(sine.dependence, Dependence::Changing, "{sine:?}");
        // The nearest preceding one of 99.9 Hz for each message at 100 Hz: a sawtooth over 1000 messages.
        let sawtooth = of(|n| (10.0 * n as f64) % 10_000.0);
        assert_eq!(sawtooth.dependence, Dependence::Changing, "{sawtooth:?}");
        // Beating within 20 messages: no block of 100 differs, but neighbours do not differ either.
        let fast = of(|n| (500.0 * n as f64) % 10_000.0 + 10.0 * normal(4, n));
        assert_eq!(fast.dependence, Dependence::Correlated, "{fast:?}");
        // Of a ratio that is the golden one, each neighbour is far away.
        let golden = of(|n| (6180.34 * n as f64) % 10_000.0);
        assert_eq!(golden.dependence, Dependence::Correlated, "{golden:?}");
    }

    #[test]
    fn latencies_that_resemble_their_neighbours_are_correlated_and_independent_ones_are_not() {
        let mut counts = [0; 2];
        for seed in 0..40 {
            let mut state = normal(seed, 5000);
            let resembling = of(|n| {
                state = 0.8 * state + 0.6 * normal(seed, n);
                1000.0 + 100.0 * state
            });
            counts[0] += usize::from(resembling.dependence == Dependence::Correlated);
            // Late by an exponential law, as a queue is: not normal.
            let independent = of(|n| 1000.0 + 50.0 * normal(seed, n).powi(2));
            counts[1] += usize::from(independent.dependence == Dependence::None);
        }
        // Each of two tests errs in one of 10⁴; one error in forty has a probability below one in a hundred.
        assert!(counts[0] >= 39 && counts[1] >= 39, "{counts:?}");
        assert_eq!(of(|_| 1000.0).dependence, Dependence::None);
        assert_eq!(TimeDependence::of(&[(0, 1); 20]).dependence, Dependence::TooFew);
    }
}
