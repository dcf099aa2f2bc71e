//! The order of a step, by halved steps from a displaced state.

use serde::Serialize;

use crate::BlackBoxError;
use crate::prober::Prober;

/// Steps of the subject over which errors add up.
const STEPS: usize = 4;
/// Halvings of the step.
const HALVINGS: usize = 6;
/// Roundings, relative to the scales, at which a difference says nothing. Errors of a thousand steps add up.
const ROUNDING: f64 = 1e-13;
/// Largest distance of an estimate from an integer, or between two estimates.
const SETTLED: f64 = 0.15;

/// The order by which results of the same duration converge.
#[derive(Clone, Debug, Serialize)]
pub struct Convergence {
    /// The nearest integer, if the last estimates agree with one; else none.
    pub order: Option<u32>,
    /// Estimates from pairs of halvings, from the longest steps to the shortest.
    pub estimates: Vec<f64>,
    /// Distances of the results of successive halvings, in units of the scales.
    pub differences: Vec<f64>,
    /// Whether halving changes no result beyond rounding: the step is exact.
    pub is_exact: bool,
}

impl Convergence {
    pub(crate) fn measure(prober: &mut Prober<'_>) -> Result<Self, BlackBoxError> {
        let subject = prober.subject;
        let start = displaced(prober, 0.1);
        let mut ends: Vec<Vec<f64>> = Vec::new();
        for halvings in 0..=HALVINGS {
            let dt = subject.dt * 2.0_f64.powi(-(halvings as i32));
            let mut x = start.clone();
            for _ in 0..STEPS << halvings {
                x = prober.step_one(&x, &subject.action, dt)?;
            }
            ends.push(x);
        }
        let distance = |pair: &[Vec<f64>]| {
            let parts = pair[0].iter().zip(&pair[1]).zip(&subject.state_scale);
            parts.map(|((a, b), scale)| ((a - b) / scale).abs()).fold(0.0, f64::max)
        };
        let differences: Vec<f64> = ends.windows(2).map(distance).collect();
        Ok(Convergence::of(differences))
    }

    fn of(differences: Vec<f64>) -> Self {
        let significant = differences.iter().take_while(|d| **d > ROUNDING).count();
        let estimates: Vec<f64> =
            differences[..significant].windows(2).map(|pair| (pair[0] / pair[1]).log2()).collect();
        // The shortest steps are nearest to the limit, until rounding is.
        let settled = |pair: &[f64]| {
            let order = pair[1].round();
            let near = |x: f64| (x - order).abs() < SETTLED;
            (order >= 1.0 && near(pair[0]) && near(pair[1])).then_some(order as u32)
        };
        let order = estimates.windows(2).rev().find_map(settled);
        Convergence { order, estimates, is_exact: significant == 0, differences }
    }
}

/// The state of the subject, displaced by a part of its scales in an irregular direction.
pub(crate) fn displaced(prober: &Prober<'_>, part: f64) -> Vec<f64> {
    let subject = prober.subject;
    let shift = |i: usize| {
        let turn = (i as f64).mul_add(0.618_033_988_749_894_9, 0.35).fract();
        if turn < 0.5 { 0.5 + turn } else { -turn }
    };
    let values = subject.state.iter().zip(&subject.state_scale).enumerate();
    values.map(|(i, (x, scale))| x + part * scale * shift(i)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_order_is_that_of_the_shortest_steps_that_rounding_leaves() {
        let of = |p: i32, floor: f64| {
            let differences = (0..6).map(|k| 1e-2 * 2.0_f64.powi(-p * k) + floor).collect();
            Convergence::of(differences).order
        };
        assert_eq!((of(1, 0.0), of(2, 1e-14), of(4, 2e-14)), (Some(1), Some(2), Some(4)));
        assert_eq!(Convergence::of(vec![1e-3, 4e-4, 3e-4, 1e-5, 9e-6, 1e-6]).order, None);
        assert!(Convergence::of(vec![0.0; 6]).is_exact);
    }
}
