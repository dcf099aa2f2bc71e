//! Envelopes of long series.

use serde::Serialize;

/// The smallest and largest value of a series in each of many buckets.
#[derive(Debug, Clone, PartialEq, Serialize, Default)]
pub struct Envelope {
    /// The abscissa of each bucket; the first and last are those of the series.
    pub x: Vec<f64>,
    /// The smallest value in each bucket.
    pub low: Vec<f64>,
    /// The largest value in each bucket.
    pub high: Vec<f64>,
}

impl Envelope {
    /// Thins a series, ordered by `x`, into at most `buckets` buckets of equal width, beside its
    /// first and last sample, which stay as they are. A bucket without a finite value is a gap.
    pub fn of(x: &[f64], y: &[f64], buckets: usize) -> Self {
        Self::thin(x, y, buckets, |x| x)
    }

    /// As [`of`](Self::of), with buckets of equal width in the logarithm of `x`. Samples at `x ≤ 0`
    /// are left out.
    pub fn log_spaced(x: &[f64], y: &[f64], buckets: usize) -> Self {
        let start = x.iter().position(|&x| x > 0.0).unwrap_or(x.len().min(y.len()));
        let start = start.min(y.len());
        Self::thin(&x[start..], &y[start..], buckets, f64::log10)
    }

    fn thin(x: &[f64], y: &[f64], buckets: usize, place: impl Fn(f64) -> f64) -> Self {
        let count = x.len().min(y.len());
        let mut envelope = Self::default();
        let Some(last) = count.checked_sub(1) else { return envelope };
        envelope.push(x[0], y[0], y[0]);
        if last == 0 {
            return envelope;
        }
        let (from, to) = (place(x[0]), place(x[last]));
        let scale = buckets.max(1) as f64 / (to - from);
        let bucket_of = |x: f64| ((place(x) - from) * scale) as usize;
        let inner = 1..last;
        let mut at = inner.start;
        while at < inner.end {
            let bucket = bucket_of(x[at]);
            let mut end = at + 1;
            while end < inner.end && bucket_of(x[end]) == bucket {
                end += 1;
            }
            let finite = || y[at..end].iter().copied().filter(|y| y.is_finite());
            // The middle sample stands for the bucket; the extremes do not depend on it.
            let middle = x[at + (end - at) / 2];
            let low = finite().fold(f64::NAN, f64::min);
            envelope.push(middle, low, finite().fold(f64::NAN, f64::max));
            at = end;
        }
        envelope.push(x[last], y[last], y[last]);
        envelope
    }

    fn push(&mut self, x: f64, low: f64, high: f64) {
        self.x.push(x);
        self.low.push(low);
        self.high.push(high);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_least_greatest_and_last_survive() {
        let x: Vec<f64> = (0..100_000).map(f64::from).collect();
        let mut y: Vec<f64> = x.iter().map(|x| (x * 0.7).sin()).collect();
        (y[31_415], y[92_653]) = (-8.0, 9.0);
        let envelope = Envelope::of(&x, &y, 400);
        assert!(envelope.x.len() <= 402, "{} buckets", envelope.x.len());
        assert_eq!((envelope.low[0], envelope.high[0]), (y[0], y[0]));
        assert_eq!(envelope.high.last(), y.last());
        assert_eq!(envelope.low.iter().copied().fold(0.0, f64::min), -8.0);
        assert_eq!(envelope.high.iter().copied().fold(0.0, f64::max), 9.0);
    }

    #[test]
    fn logarithmic_buckets_are_even_per_decade() {
        let x: Vec<f64> = (0..=1_000_000).map(f64::from).collect();
        let envelope = Envelope::log_spaced(&x, &x, 60);
        assert_eq!(envelope.x[0], 1.0);
        assert_eq!(envelope.x.last(), Some(&1e6));
        let per = |lo: f64, hi: f64| envelope.x.iter().filter(|&&x| x > lo && x < hi).count();
        assert_eq!((per(1e3, 1e4), per(1e4, 1e5)), (10, 10));
    }

    #[test]
    fn a_bucket_of_nothing_is_a_gap() {
        let x: Vec<f64> = (0..100).map(f64::from).collect();
        let y: Vec<f64> =
            x.iter().map(|&x| if (40.0..60.0).contains(&x) { f64::NAN } else { x }).collect();
        assert!(Envelope::of(&x, &y, 10).low.iter().any(|low| low.is_nan()));
    }
}
