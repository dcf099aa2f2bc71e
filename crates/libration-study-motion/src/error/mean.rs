//! Root mean squares of numbers whose squares may overflow.

/// A sum of squares, as `scale² · sum` with the largest magnitude so far as the scale.
///
/// Blue, ACM TOMS 4, 15 (1978); the loop is that of the BLAS routine `nrm2`.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SumOfSquares {
    scale: f64,
    sum: f64,
}

impl SumOfSquares {
    pub(super) fn add(&mut self, x: f64) {
        let x = x.abs();
        if x > self.scale {
            self.sum = 1.0 + self.sum * (self.scale / x).powi(2);
            self.scale = x;
        } else if x > 0.0 {
            self.sum += (x / self.scale).powi(2);
        }
    }

    /// The root of the mean over `count` numbers.
    pub(super) fn root_mean(self, count: u64) -> f64 {
        self.scale * (self.sum / count as f64).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_of_numbers_whose_squares_overflow_or_vanish_is_right() {
        for size in [1e200, 1.0, 1e-200] {
            let mut squares = SumOfSquares::default();
            [3.0, 0.0, -4.0, 0.0].iter().for_each(|x| squares.add(size * x));
            let mean = squares.root_mean(4);
            // Four roundings and one division.
            assert!((mean / size - 2.5).abs() < 1e-15, "{size}: {mean}");
        }
    }
}
