//! Fit of a power law, with its uncertainty.

use libration_report::record::Tolerance;

/// Number of points of a fit: the last ones, with the smallest steps.
const WINDOW: usize = 5;

/// Largest difference of slopes between successive points of a settled exponent.
const SETTLED: f64 = 0.01;

/// The widest tolerance on an exponent: half a fifth of the distance between two orders.
const WIDEST: f64 = 0.2;

/// `y = C·xᵖ`, by least squares on logarithms over the last points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// The exponent `p`.
    pub exponent: f64,
    /// Its standard error.
    pub standard_error: f64,
    /// Bound of the shift by the next term of the expansion.
    pub bend: f64,
}

impl Fit {
    /// Fits the last points, for an `x` that is halved from each to the next. Returns none if there are
    /// too few points or one is not positive and finite.
    pub fn new(x: &[f64], y: &[f64]) -> Option<Self> {
        let skipped = x.len().min(y.len()).checked_sub(WINDOW)?;
        let points: Vec<(f64, f64)> =
            x.iter().zip(y).skip(skipped).map(|(x, y)| (x.ln(), y.ln())).collect();
        if points.iter().any(|(x, y)| !(x.is_finite() && y.is_finite())) {
            return None;
        }
        let n = points.len() as f64;
        let mean = |f: fn(&(f64, f64)) -> f64| points.iter().map(f).sum::<f64>() / n;
        let (x0, y0) = (mean(|p| p.0), mean(|p| p.1));
        let spread: f64 = points.iter().map(|(x, _)| (x - x0).powi(2)).sum();
        let exponent = points.iter().map(|(x, y)| (x - x0) * (y - y0)).sum::<f64>() / spread;
        let residue: f64 = points.iter().map(|(x, y)| (y - y0 - exponent * (x - x0)).powi(2)).sum();
        let slopes: Vec<f64> =
            points.windows(2).map(|p| (p[1].1 - p[0].1) / (p[1].0 - p[0].0)).collect();
        let [.., previous, last] = slopes[..] else { return None };
        Some(Fit {
            exponent,
            standard_error: (residue / (n - 2.0) / spread).sqrt(),
            bend: (exponent - last).abs() + (last - previous).abs(),
        })
    }

    /// Whether the exponent of the last points is settled, so that no smaller step is required.
    pub fn is_settled(x: &[f64], y: &[f64]) -> bool {
        // The slopes at both ends of the window: a chance agreement of two is not enough.
        let slope = |i: usize| (y[i + 1] / y[i]).ln() / (x[i + 1] / x[i]).ln();
        let n = x.len();
        n >= WINDOW && (n - WINDOW..n - 2).all(|i| (slope(i + 1) - slope(i)).abs() < SETTLED)
    }

    /// Returns the largest distance of the exponent from the limit of small steps.
    ///
    /// With `e = C·hᵖ(1 + c·hᵏ + …)` the slope between `2h` and `h` differs from `p` by a multiple
    /// of `hᵏ`, `k ≥ 1`: the last slope is off by at most its difference from the one before.
    pub fn uncertainty(&self) -> f64 {
        (2.0 * self.standard_error + self.bend).min(WIDEST)
    }

    /// Whether the exponent is known well enough to tell whole orders apart.
    pub fn tells_orders_apart(&self) -> bool {
        self.uncertainty() < WIDEST
    }

    /// Returns the tolerance of an order on a system of which nothing is known beforehand, if the exponent
    /// [tells orders apart](Self::tells_orders_apart).
    pub fn order_tolerance() -> Tolerance {
        Tolerance::absolute(
            WIDEST,
            "orders are whole numbers, which a fifth of their distance tells apart on any system",
        )
    }

    /// Returns the uncertainty as a tolerance with its reason.
    pub fn tolerance(&self) -> Tolerance {
        Tolerance::absolute(
            self.uncertainty(),
            format!(
                "two standard errors of the fit, and the bend of the next term: at most the \
                 distance of the last slope from the fit and from the slope before; never above \
                 {WIDEST}"
            ),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn law(f: impl Fn(f64) -> f64) -> (Vec<f64>, Vec<f64>) {
        let x: Vec<f64> = (0..8).map(|i| 0.1 * 0.5_f64.powi(i)).collect();
        let y = x.iter().map(|&x| f(x)).collect();
        (x, y)
    }

    #[test]
    fn the_bend_covers_the_next_term() {
        for (p, c) in [(1.0, 2.0), (2.0, -3.0), (4.0, 5.0)] {
            for k in [1, 2] {
                let (x, y) = law(|x| x.powf(p) * (1.0 + c * x.powi(k)));
                let fit = Fit::new(&x, &y).unwrap();
                let off = (fit.exponent - p).abs();
                assert!(off > 0.0 && off <= fit.uncertainty(), "{p} {c} {k}: {fit:?}");
            }
        }
    }

    #[test]
    fn a_wrong_exponent_is_never_covered() {
        // A curve that bends from slope 1 to slope 2 within the window has no exponent.
        let (x, y) = law(|x| x * (x + 2e-3));
        let fit = Fit::new(&x, &y).unwrap();
        assert!(!Fit::is_settled(&x, &y));
        assert!((fit.exponent - 1.0).abs() > fit.uncertainty());
        assert!((fit.exponent - 2.0).abs() > fit.uncertainty());
    }

    #[test]
    fn what_has_no_logarithm_has_no_law() {
        let (x, mut y) = law(|x| x);
        y[7] = 0.0;
        assert_eq!(Fit::new(&x, &y), None);
        y[7] = f64::NAN;
        assert_eq!(Fit::new(&x, &y), None);
        assert!(!Fit::is_settled(&x, &y));
    }
}
