//! The growth of small deviations, measured.

use core::ops::RangeInclusive;

use num_complex::Complex64;

/// Squares of deviations, and their growth.
pub(crate) struct Growth {
    /// The first deviation of each state.
    pub(crate) small: f64,
    /// Deviations, as parts of the first, that are neither too large for a linear system nor too small for their digits.
    range: RangeInclusive<f64>,
    /// Logarithms of the squares, as if none had been made small again.
    logarithms: Vec<f64>,
    /// The logarithm of what the squares were divided by.
    removed: f64,
}

impl Growth {
    /// Of states of this size, whose deviations are made small again whenever they leave a range.
    pub(crate) fn new(scale: f64) -> Self {
        Growth::within(1e-5 * scale, 1e-4..=1e2)
    }

    /// Of states of this size, over as long a range as has digits.
    pub(crate) fn of_one_range(scale: f64) -> Self {
        Growth::within(1e-3 * scale, 1e-9..=1e2)
    }

    fn within(small: f64, range: RangeInclusive<f64>) -> Self {
        Growth { small, range, logarithms: Vec::new(), removed: 0.0 }
    }

    /// Notes the square of a deviation. Returns the factor by which the deviation must be multiplied; none if it is not a number
    /// or zero.
    pub(crate) fn push(&mut self, square: f64) -> Option<f64> {
        if !square.is_finite() || square <= 0.0 {
            return None;
        }
        self.logarithms.push(square.ln() + self.removed);
        let ratio = square.sqrt() / self.small;
        if self.range.contains(&ratio) {
            return Some(1.0);
        }
        self.removed += 2.0 * ratio.ln();
        Some(ratio.recip())
    }

    /// The growth of the logarithm of a deviation per entry, from the largest of the second and of the last quarter; none if a
    /// quarter has fewer than `least` entries.
    pub(crate) fn rate(&self, least: usize) -> Option<f64> {
        let n = self.logarithms.len();
        let quarter = n / 4;
        if quarter < least.max(2) {
            return None;
        }
        // Without the growth found so far, the largest is the same in each turn of a swing, wherever a quarter begins.
        let mut slope = 0.0;
        for _ in 0..4 {
            let largest = |from: usize| {
                let rest = (from..from + quarter).map(|i| self.logarithms[i] - slope * i as f64);
                rest.fold(f64::NEG_INFINITY, f64::max)
            };
            slope += (largest(n - quarter) - largest(quarter)) / (n - 2 * quarter) as f64;
        }
        Some(0.5 * slope)
    }
}

/// The entries in half a turn of the slowest swing among the eigenvalues of the largest size: the size of a deviation is the same in each
/// half turn.
pub(crate) fn least_entries(eigenvalues: &[Complex64]) -> usize {
    let largest = eigenvalues.iter().map(|value| value.norm()).fold(0.0, f64::max);
    let leading = eigenvalues.iter().filter(|value| value.norm() > (1.0 - 1e-3) * largest);
    let angles = leading.map(|value| value.arg().abs()).filter(|angle| *angle > 1e-9);
    angles.map(|angle| (core::f64::consts::PI / angle).ceil() as usize).max().unwrap_or(2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_growth_of_a_swing_is_that_of_its_amplitude_whatever_its_size() {
        for rate in [-0.3, -0.001, 0.0, 0.02, 0.7_f64] {
            let mut growth = Growth::new(1.0);
            let mut size = growth.small;
            for k in 0..4000 {
                let swing = 0.6 + 0.4 * f64::from(k).sin();
                size *= growth.push((size * swing).powi(2)).unwrap() * rate.exp();
            }
            // A maximum is met to within half a step of 1 rad, where the swing is 0.95: ln 0.95 over 2000 entries.
            assert!((growth.rate(4).unwrap() - rate).abs() < 3e-5, "{rate}: {:?}", growth.rate(4));
        }
        let mut growth = Growth::new(1.0);
        assert_eq!([growth.push(0.0), growth.push(f64::NAN), growth.rate(0)], [None; 3]);
    }
}
