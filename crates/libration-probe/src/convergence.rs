//! The order of a step, by halved steps from a displaced state.

use libration_report::notation::number;
use serde::Serialize;

use crate::BlackBoxError;
use crate::prober::Prober;
use crate::settled_order::settled_order;

/// Steps of the subject over which errors add up.
const STEPS: usize = 4;
/// Halvings of the step, at least and at most: more while the order has not settled.
const HALVINGS: [usize; 2] = [6, 10];

/// The order by which results of the same duration converge.
#[derive(Clone, Debug, Serialize)]
pub struct Convergence {
    /// The lowest order of a state, if its last estimates agree with an integer; none if they do not, or if the run diverges.
    pub order: Option<u32>,
    /// Estimates of this state from pairs of halvings, from the longest steps to the shortest.
    pub estimates: Vec<f64>,
    /// Distances of its results of successive halvings, in units of the scale.
    pub differences: Vec<f64>,
    /// Whether halving changes no result beyond rounding: the step is exact.
    pub is_exact: bool,
}

impl Convergence {
    /// The estimates, separated by commas.
    pub fn in_words(&self) -> String {
        self.estimates.iter().map(|x| number(*x, 4)).collect::<Vec<_>>().join(", ")
    }

    pub(crate) fn measure(prober: &mut Prober<'_>) -> Result<Self, BlackBoxError> {
        let mut ends: Vec<Vec<f64>> = Vec::new();
        for halvings in 0..=HALVINGS[1] {
            ends.push(end(prober, halvings)?);
            if halvings >= HALVINGS[0] {
                let found = Convergence::of_ends(&ends, &prober.subject.state_scale);
                if found.order.is_some() || found.is_exact {
                    return Ok(found);
                }
            }
        }
        Ok(Convergence::of_ends(&ends, &prober.subject.state_scale))
    }

    /// The order of the state that converges with the lowest one.
    fn of_ends(ends: &[Vec<f64>], scale: &[f64]) -> Self {
        let of_state = |i: usize| {
            let distance = |pair: &[Vec<f64>]| ((pair[0][i] - pair[1][i]) / scale[i]).abs();
            Convergence::of(ends.windows(2).map(distance).collect())
        };
        let all: Vec<Convergence> = (0..scale.len()).map(of_state).collect();
        // A state without an order leaves the order of the step unknown.
        let known = |found: &&Convergence| !found.is_exact;
        let lowest = all.iter().filter(known).min_by_key(|found| found.order.unwrap_or(0));
        lowest.or(all.first()).cloned().unwrap_or_else(|| Convergence::of(Vec::new()))
    }

    fn of(differences: Vec<f64>) -> Self {
        let (order, estimates, is_exact) = settled_order(&differences);
        Convergence { order, estimates, is_exact, differences }
    }
}

/// The end of a run from a displaced state with halved steps; NaN if it diverges.
fn end(prober: &mut Prober<'_>, halvings: usize) -> Result<Vec<f64>, BlackBoxError> {
    let subject = prober.subject;
    let dt = subject.dt * 2.0_f64.powi(-(halvings as i32));
    let mut x = displaced(prober, 0.1);
    // A method may be exact while no force acts.
    let scales = subject.action.iter().zip(&subject.action_scale);
    let action: Vec<f64> = scales.map(|(u, scale)| u + scale / 64.0).collect();
    // Earlier calls are forgotten.
    prober.step_one(&x, &action, dt)?;
    for _ in 0..STEPS << halvings {
        match prober.advance(&x, &action, dt) {
            Ok(next) => x = next,
            Err(BlackBoxError::NotFinite { .. }) => return Ok(vec![f64::NAN; x.len()]),
            Err(error) => return Err(error),
        }
    }
    Ok(x)
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
