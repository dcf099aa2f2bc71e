//! The cost of a loop under noise.

use libration::analysis::{CostError, Imperfections, Plant};
use libration::control::{Feedback, Jitter, Latency, LqrWeights};
use serde::Serialize;

use super::Timing;

/// The stationary cost of a loop under white noise of the acceleration of unit intensity.
#[derive(Debug, Serialize)]
pub struct LoopCost {
    /// The weights `[q, v, u]` of the squares in the mean cost.
    pub cost_weights: [f64; 3],
    /// The cost with the latency, jitter, skew (half the clocks slow by its rms, half fast) and loss of the request; none if
    /// it is infinite or unknown.
    pub cost: Option<f64>,
    /// Whether the cost is infinite, because the loop is unstable in the mean square. Unknown if the loop is too large.
    pub cost_infinite: Option<bool>,
    /// `J/J₀ − 1` with the cost `J₀` of the ideal loop; none if either is none.
    pub cost_increase: Option<f64>,
}

impl LoopCost {
    /// The same cost with the weights in the units of the request.
    pub(super) fn with_given_weights(self, given: Option<LqrWeights>) -> Self {
        let weights = given.map(|w| [w.position, w.velocity, w.command]);
        LoopCost { cost_weights: weights.unwrap_or(self.cost_weights), ..self }
    }

    pub(super) fn of(
        plant: &Plant<'_>,
        feedback: Feedback,
        latency: Latency,
        timing: &Timing,
    ) -> Self {
        let weights = timing.weights.unwrap_or_else(|| plant.energy());
        let cost = |imperfections: &Imperfections| -> Result<f64, CostError> {
            plant.cost(&feedback.into(), imperfections, weights)
        };
        let none = Imperfections::NONE;
        let jitter = timing.jitter.unwrap_or(none.jitter);
        let loss = timing.loss.unwrap_or(0.0);
        let with = |skew| cost(&Imperfections { latency, jitter, skew, loss });
        let all = match timing.skew.map(Jitter::rms).filter(|&rms| rms > 0.0) {
            Some(rms) => with(rms).and_then(|slow| Ok(0.5 * (slow + with(-rms)?))),
            None => with(0.0),
        };
        let all = all.ok();
        let finite = |cost: Option<f64>| cost.filter(|cost| cost.is_finite());
        let increase = finite(all).zip(finite(cost(&none).ok()));
        LoopCost {
            cost_weights: [weights.position, weights.velocity, weights.command],
            cost: finite(all),
            cost_infinite: all.map(f64::is_infinite),
            cost_increase: increase.map(|(all, ideal)| all / ideal - 1.0),
        }
    }
}
