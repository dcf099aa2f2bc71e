//! Drift between two clocks.

use serde::Serialize;

/// The difference of two clocks as a line over time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Drift {
    /// The number of messages with both clocks.
    pub count: usize,
    /// The median of the difference, in s.
    pub offset: f64,
    /// By how much the difference rises, in parts per million.
    pub skew_ppm: f64,
    /// Half the width of the interval that contains the skew with a probability of 95 %, in parts per million.
    pub half_width_ppm: f64,
}

/// Parts of the record between which deviations are taken as independent.
const BLOCKS: usize = 20;
/// The 97.5 % quantile of Student's law with 19 degrees of freedom.
const STUDENT: f64 = 2.093;
/// Fewest messages of a part.
const FEWEST: usize = 4;

impl Drift {
    /// The drift of `clock` against `reference`, both in ns: the line of least squares. Its interval is robust to deviations that are
    /// correlated over less than a twentieth of the record (standard errors by blocks: K.-Y. Liang, S. L. Zeger, *Longitudinal data
    /// analysis using generalized linear models*, Biometrika 73, 1986). None for few messages or no time.
    pub fn between(reference: &[Option<i64>], clock: &[Option<i64>]) -> Option<Self> {
        let mut pairs: Vec<(i64, i128)> = reference
            .iter()
            .zip(clock)
            .filter_map(|(&a, &b)| Some((a?, i128::from(b?) - i128::from(a?))))
            .collect();
        // Of messages that repeat a stamp, only the first is as old as its stamp says.
        pairs.sort_unstable();
        pairs.dedup_by_key(|pair| pair.0);
        if pairs.len() < BLOCKS * FEWEST {
            return None;
        }
        let mut differences: Vec<i128> = pairs.iter().map(|pair| pair.1).collect();
        differences.sort_unstable();
        let median = differences[differences.len() / 2];
        let origin = i128::from(pairs[0].0);
        let x: Vec<f64> = pairs.iter().map(|pair| (i128::from(pair.0) - origin) as f64).collect();
        let y: Vec<f64> = pairs.iter().map(|pair| (pair.1 - median) as f64).collect();
        let count = x.len() as f64;
        let mean = |values: &[f64]| values.iter().sum::<f64>() / count;
        let (x_mean, y_mean) = (mean(&x), mean(&y));
        let square: f64 = x.iter().map(|x| (x - x_mean).powi(2)).sum();
        if square == 0.0 {
            return None;
        }
        let product: f64 = x.iter().zip(&y).map(|(x, y)| (x - x_mean) * (y - y_mean)).sum();
        let skew = product / square;
        let score = |(x, y): (&f64, &f64)| (x - x_mean) * (y - y_mean - skew * (x - x_mean));
        let length = x.len().div_ceil(BLOCKS);
        let scores = x.chunks(length).zip(y.chunks(length));
        let sums = scores.map(|(x, y)| x.iter().zip(y).map(score).sum::<f64>().powi(2));
        let variance = sums.sum::<f64>() * BLOCKS as f64 / (BLOCKS - 1) as f64;
        Some(Drift {
            count: x.len(),
            offset: median as f64 / 1e9,
            skew_ppm: 1e6 * skew,
            half_width_ppm: 1e6 * STUDENT * variance.sqrt() / square,
        })
    }
}

#[cfg(test)]
mod tests {
    use libration::random::{Address, Purpose};

    use super::*;

    #[test]
    fn a_fast_clock_is_found_within_its_interval() {
        let mut inside = 0;
        for seed in 0..200 {
            let noise = |n: u64| {
                let address = Address { seed, trajectory: 0, step: n, purpose: Purpose::StepTime };
                (100_000.0 * address.gaussian()[0]) as i64
            };
            let start = 1_700_000_000_000_000_000_i64;
            let reference: Vec<_> = (0..1000).map(|n| Some(start + n * 10_000_000)).collect();
            let clock: Vec<_> = (0..1000)
                .map(|n| Some(start + n * 10_000_000 + n * 300 + 2_000_000 + noise(n as u64)))
                .collect();
            let drift = Drift::between(&reference, &clock).unwrap();
            assert!((drift.offset - 2.15e-3).abs() < 5e-5, "{drift:?}");
            // 300 ns in 10 ms are 30 ppm; the noise of 0.1 ms leaves 1 ppm.
            assert!(drift.half_width_ppm > 1.0 && drift.half_width_ppm < 4.5, "{drift:?}");
            inside += usize::from((drift.skew_ppm - 30.0).abs() < drift.half_width_ppm);
        }
        // 95 % of 200, and four standard deviations below.
        assert!(inside >= 177, "{inside}");
    }

    #[test]
    fn messages_that_repeat_a_stamp_do_not_shift_the_offset() {
        let reference: Vec<_> = (0..1000).map(|n| Some(1000 + n / 5 * 10_000_000)).collect();
        let clock: Vec<_> = (0..1000).map(|n| Some(3000 + n * 2_000_000)).collect();
        let drift = Drift::between(&reference, &clock).unwrap();
        assert_eq!((drift.count, drift.offset), (200, 2e-6));
    }

    #[test]
    fn few_messages_have_no_drift() {
        assert_eq!(Drift::between(&[Some(1); 10], &[Some(2); 10]), None);
        assert_eq!(Drift::between(&[Some(1); 200], &[Some(2); 200]), None);
        assert_eq!(Drift::between(&[Some(1); 200], &[None; 200]), None);
    }
}
