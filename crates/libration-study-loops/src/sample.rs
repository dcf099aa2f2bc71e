//! Means over many trajectories, with standard errors.
//!
//! It uses nothing of the crate: the tests of `tests/study_loops` compile it alone, in place of the whole crate once more.

/// Standard errors within which a number among many must lie.
pub(super) const ERRORS: f64 = 4.0;

/// Reason for this number of standard errors.
pub(super) const WHY_ERRORS: &str =
    "four standard errors, since there are many such numbers: one of 16 000 lies beyond by chance";

/// Moments of a sample.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    count: f64,
    pub(super) mean: f64,
    pub(super) deviation: f64,
}

impl Sample {
    pub(super) fn of(values: &[f64]) -> Self {
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let squares = values.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>();
        Sample { count, mean, deviation: (squares / (count - 1.0)).sqrt() }
    }

    /// The standard error of the mean.
    pub(super) fn error(&self) -> f64 {
        self.deviation / self.count.sqrt()
    }

    /// The standard error of the deviation of Gaussian numbers, as a part of it.
    pub(super) fn error_of_deviation(&self) -> f64 {
        (2.0 * (self.count - 1.0)).sqrt().recip()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sample_has_the_moments_of_the_textbook() {
        let sample = Sample::of(&[1.0, 2.0, 3.0, 6.0]);
        assert_eq!((sample.mean, sample.deviation), (3.0, (14.0_f64 / 3.0).sqrt()));
        assert_eq!(sample.error(), sample.deviation / 2.0);
        assert_eq!(sample.error_of_deviation(), 6.0_f64.sqrt().recip());
    }
}
