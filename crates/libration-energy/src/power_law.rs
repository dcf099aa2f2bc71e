//! Power laws of the time step.

use serde::Serialize;

use crate::Estimate;
use crate::estimate::NORMAL_95;
use crate::normal_equations::{Row, least_squares};

/// Smallest relative standard error of a point: rounding of a result.
const LEAST_ERROR: f64 = 1e-9;

/// The law `coefficient · dtᵉˣᵖᵒⁿᵉⁿᵗ` through sizes at several steps.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct PowerLaw {
    /// Size at a step of 1 s.
    pub coefficient: f64,
    /// Exponent. If points scatter more than their intervals allow, the interval is that of the scatter.
    pub exponent: Estimate,
    /// Number of steps.
    pub points: usize,
}

impl PowerLaw {
    /// Fits the sizes of estimates that exclude 0, by least squares of logarithms. None for fewer than two.
    pub(crate) fn fit(points: &[(f64, Estimate)]) -> Option<Self> {
        let known = |(_, estimate): &&(f64, Estimate)| estimate.smallest_size() > 0.0;
        let known: Vec<&(f64, Estimate)> = points.iter().filter(known).collect();
        let row = |(dt, estimate): &&(f64, Estimate)| -> Row {
            let width = (estimate.largest_size() / estimate.smallest_size()).ln();
            let weight = 1.0 / (width / (2.0 * NORMAL_95)).max(LEAST_ERROR);
            ([weight, weight * dt.ln(), 0.0], weight * estimate.value.abs().ln())
        };
        let rows: Vec<Row> = known.iter().map(row).collect();
        let fit = least_squares(&rows, 2)?;
        let freedom = rows.len() as f64 - 2.0;
        let scatter = if freedom > 0.0 { (fit.residual / freedom).sqrt().max(1.0) } else { 1.0 };
        let half_width = NORMAL_95 * scatter * fit.inverse_diagonal[1].sqrt();
        Some(PowerLaw {
            coefficient: fit.coefficients[0].exp(),
            exponent: Estimate::symmetric(fit.coefficients[1], half_width),
            points: rows.len(),
        })
    }
}

/// The exponent between two steps. Errors of the two sizes are independent; a size that may be 0 bounds it on one side only.
pub(crate) fn local_exponent(short: (f64, Estimate), long: (f64, Estimate)) -> Estimate {
    let ratio = (long.0 / short.0).ln();
    let up = |size: &Estimate| (size.largest_size() / size.value.abs()).ln();
    let down = |size: &Estimate| (size.value.abs() / size.smallest_size()).ln();
    let value = (long.1.value / short.1.value).abs().ln() / ratio;
    let known = |x: f64, otherwise: f64| if x.is_nan() { otherwise } else { x };
    Estimate {
        value,
        low: known(value - down(&long.1).hypot(up(&short.1)) / ratio, f64::NEG_INFINITY),
        high: known(value + up(&long.1).hypot(down(&short.1)) / ratio, f64::INFINITY),
    }
}
