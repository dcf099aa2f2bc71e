//! A cost with a fixed part: `a + b·x`.

/// A straight line through times.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Line {
    /// Fixed cost.
    pub(super) fixed: f64,
    /// Cost per unit.
    pub(super) each: f64,
}

impl Line {
    /// The line with the least squares of relative residuals: times are known to a share of them, whatever their size.
    pub(super) fn through(x: &[f64], times: &[f64]) -> Line {
        // With 1/t for a weight, both sides of `(a + b·x)/t = 1`.
        let sum =
            |of: fn(f64, f64) -> f64| x.iter().zip(times).map(|(&x, &t)| of(x, t)).sum::<f64>();
        let (one, first, second) =
            (sum(|_, t| 1.0 / (t * t)), sum(|x, t| x / (t * t)), sum(|x, t| x * x / (t * t)));
        let (right, right_first) = (sum(|_, t| 1.0 / t), sum(|x, t| x / t));
        let determinant = one * second - first * first;
        Line {
            fixed: (right * second - first * right_first) / determinant,
            each: (one * right_first - first * right) / determinant,
        }
    }

    /// Its value.
    pub(super) fn at(&self, x: f64) -> f64 {
        self.fixed + self.each * x
    }

    /// Returns the relative distance of a time from the line.
    pub(super) fn residual(&self, x: f64, time: f64) -> f64 {
        (time - self.at(x)) / time
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_found_and_what_is_off_it_is_told_as_a_share() {
        let x = [1.0, 10.0, 100.0];
        let line = Line::through(&x, &x.map(|x| 3.0 + 0.5 * x));
        assert!((line.fixed - 3.0).abs() < 1e-12 && (line.each - 0.5).abs() < 1e-12, "{line:?}");
        assert!((line.residual(2.0, 8.0) - 0.5).abs() < 1e-12);
        // A large time that is off by a few percent moves a small one by no more than that.
        let line = Line::through(&x, &[3.5, 8.0, 53.0 * 1.05]);
        assert!(line.residual(1.0, 3.5).abs() < 0.05, "{line:?}");
    }
}
