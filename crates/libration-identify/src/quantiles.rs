//! Quantiles and tail probabilities of the laws of statistics.

use statrs::distribution::{ChiSquared, ContinuousCDF, Normal, StudentsT};

/// The level of all intervals.
pub const LEVEL: f64 = 0.95;

/// The two-sided quantile of Student's law.
pub(crate) fn student(freedom: f64) -> f64 {
    let law = StudentsT::new(0.0, 1.0, freedom.max(1.0));
    law.map_or(f64::INFINITY, |law| law.inverse_cdf(0.5 + 0.5 * LEVEL))
}

/// The probability that a chi-squared number with `freedom` degrees of freedom is above `x`.
pub(crate) fn chi_squared_tail(x: f64, freedom: f64) -> f64 {
    ChiSquared::new(freedom.max(1.0)).map_or(1.0, |law| law.sf(x.max(0.0)))
}

/// The probability that a normal number is above `x` in absolute value.
pub(crate) fn normal_tails(x: f64) -> f64 {
    Normal::new(0.0, 1.0).map_or(1.0, |law| 2.0 * law.sf(x.abs()))
}

/// The probability that a normal number is below `x`.
pub(crate) fn normal_probability(x: f64) -> f64 {
    Normal::new(0.0, 1.0).map_or(0.5, |law| law.cdf(x))
}

/// The normal number below which a number is with this probability; finite also for probabilities that round to 0 and 1.
pub(crate) fn normal_quantile(probability: f64) -> f64 {
    let inside = probability.clamp(1e-16, 1.0 - 1e-16);
    Normal::new(0.0, 1.0).map_or(0.0, |law| law.inverse_cdf(inside))
}
