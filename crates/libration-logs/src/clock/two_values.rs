//! The law of two values.

use std::f64::consts::{PI, SQRT_2};

/// Fewest values of each of two parts.
const FEWEST: usize = 10;
/// Least share of each of two parts.
const LEAST_SHARE: f64 = 0.02;
/// Least standard deviation of a part over that of the other.
const NARROWEST: f64 = 0.02;
/// Least separation of two parts (K. A. Ashman, C. M. Bird, S. E. Zepf, *Detecting bimodality in astronomical datasets*, Astronomical
/// Journal 108, 1994).
const SEPARATION: f64 = 2.0;

/// Steps of the expectation-maximisation of two values.
const STEPS: usize = 60;

/// Largest density between two values over the density at both.
const DIP: f64 = 0.9;

/// Two values, each with a Gaussian spread.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TwoValues {
    pub(super) values: [f64; 2],
    pub(super) deviations: [f64; 2],
    /// The share of the second value.
    pub(super) share: f64,
}

impl TwoValues {
    fn density(&self, x: f64) -> f64 {
        let part = |i: usize| {
            normal_density((x - self.values[i]) / self.deviations[i]) / self.deviations[i]
        };
        (1.0 - self.share) * part(0) + self.share * part(1)
    }

    /// Whether the density is lower between the values than at both.
    fn has_dip(&self) -> bool {
        let [low, high] = self.values;
        let between = |i: i32| self.density(low + (high - low) * f64::from(i) / 64.0);
        let least = (1..64).map(between).fold(f64::INFINITY, f64::min);
        least < DIP * between(0).min(between(64))
    }
}

/// Two Gaussian laws by expectation-maximisation (A. P. Dempster, N. M. Laird, D. B. Rubin, *Maximum likelihood from incomplete data
/// via the EM algorithm*, Journal of the Royal Statistical Society B 39, 1977), from the two sides of the widest gap.
pub(super) fn two_values(sorted: &[f64]) -> Option<TwoValues> {
    let count = sorted.len();
    let range = sorted[count - 1] - sorted[0];
    // A few values on one side are outliers.
    let least = (count / 50).max(FEWEST);
    if count < 2 * least {
        return None;
    }
    let gap = |i: usize| sorted[i] - sorted[i - 1];
    let split = (least..=count - least).max_by(|&a, &b| gap(a).total_cmp(&gap(b)))?;
    let of = |part: &[f64]| {
        let mean = part.iter().sum::<f64>() / part.len() as f64;
        let square = part.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / part.len() as f64;
        (mean, square.sqrt())
    };
    // A value without any spread has the likelihood infinity.
    let floor = 1e-4 * range;
    let (low, high) = (of(&sorted[..split]), of(&sorted[split..]));
    let mut law =
        ([low.0, high.0], [low.1.max(floor), high.1.max(floor)], 1.0 - split as f64 / count as f64);
    for _ in 0..STEPS {
        let (values, deviations, share) = law;
        let mut sums = [[0.0; 3]; 2];
        for &x in sorted {
            let density =
                |i: usize| normal_density((x - values[i]) / deviations[i]) / deviations[i];
            let (a, b) = ((1.0 - share) * density(0), share * density(1));
            let second = if a + b > 0.0 {
                b / (a + b)
            } else {
                f64::from((x - values[1]).abs() < (x - values[0]).abs())
            };
            for (sum, weight) in sums.iter_mut().zip([1.0 - second, second]) {
                let x = x - sorted[0];
                sum[0] += weight;
                sum[1] += weight * x;
                sum[2] += weight * x * x;
            }
        }
        if sums.iter().any(|sum| sum[0] < 1.0) {
            break;
        }
        let mean = |sum: &[f64; 3]| sum[1] / sum[0];
        let deviation =
            |sum: &[f64; 3]| (sum[2] / sum[0] - mean(sum).powi(2)).max(0.0).sqrt().max(floor);
        let own = [deviation(&sums[0]), deviation(&sums[1])];
        law = (
            [sorted[0] + mean(&sums[0]), sorted[0] + mean(&sums[1])],
            [own[0].max(NARROWEST * own[1]), own[1].max(NARROWEST * own[0])],
            sums[1][0] / count as f64,
        );
    }
    let (values, deviations, share) = law;
    let smaller = share.min(1.0 - share);
    let distance = (values[1] - values[0]).abs();
    let separation = SQRT_2 * distance / deviations[0].hypot(deviations[1]);
    if smaller < LEAST_SHARE || smaller * (count as f64) < FEWEST as f64 || separation <= SEPARATION
    {
        return None;
    }
    let found = TwoValues { values, deviations, share };
    found.has_dip().then_some(found)
}

/// The density of the normal distribution.
pub(super) fn normal_density(z: f64) -> f64 {
    (-0.5 * z * z).exp() / (2.0 * PI).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_peak_and_one_outlier_are_not_two_values() {
        let peak = |i: i32| f64::from(i % 97) / 97.0 + f64::from(i % 89) / 89.0;
        let sorted = |mut values: Vec<f64>| {
            values.sort_unstable_by(f64::total_cmp);
            values
        };
        let mut values = sorted((0..4000).map(peak).collect());
        assert_eq!(two_values(&values), None);
        values.push(1000.0);
        assert_eq!(two_values(&values), None);
        let two = |i: i32| f64::from(i % 2) + 0.01 * peak(i);
        assert!(two_values(&sorted((0..4000).map(two).collect())).is_some());
    }
}
