//! Growth of a loop under random steps and losses.

use libration::Scalar;
use libration::analysis::{Imperfections, Plant};
use libration::control::{Feedback, Latency};
use libration::linear::GROWTH_ROUNDING;
use libration::number::Wide;
use serde::Serialize;

use super::Timing;
use super::modes::unless_rounding;

/// The growth of a loop per step with its latency, jitter and losses, for a clock at its nominal rate.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct LoopGrowth {
    /// `ρ(E[M ⊗ M])`: the growth factor of second moments per step; none if a deviation turns by more than 2048 rad, or
    /// if the latency exceeds 90 steps.
    pub mean_square_radius: Option<f64>,
    /// The same minus one, without cancellation.
    pub mean_square_growth: Option<f64>,
    /// The largest Lyapunov exponent per step; none with a latency or losses, if the mean step does not turn, or if a
    /// deviation turns by more than 2048 rad.
    pub lyapunov_exponent: Option<f64>,
}

impl LoopGrowth {
    pub(super) fn of(
        plant: &Plant<'_>,
        feedback: Feedback,
        latency: Latency,
        timing: &Timing,
    ) -> Self {
        let none = Imperfections::NONE;
        let jitter = timing.jitter.unwrap_or(none.jitter);
        let loss = timing.loss.unwrap_or(none.loss);
        // A loop that waits for no command is a product of matrices of two rows.
        let ([radius, growth], exponent) = if latency == Latency::NONE && loss == 0.0 {
            let radius = plant.mean_square(feedback, jitter).radius;
            let moments = [radius, unless_rounding(radius - Wide::one())].map(Wide::to_f64);
            // Of steps that are all alike second moments grow by the square of the spectral radius.
            let exponent = match jitter.rms() {
                0.0 => Some(0.5 * radius.ln().to_f64()),
                _ => plant.lyapunov_exponent(feedback, jitter),
            };
            (moments, exponent)
        } else {
            let drawn = Imperfections { latency, jitter, loss, ..none };
            let rate = plant.mean_square_growth(&feedback.into(), &drawn).unwrap_or(f64::NAN);
            let rate = if rate.abs() <= GROWTH_ROUNDING { 0.0 } else { rate };
            ([rate.exp(), rate.exp_m1()], None)
        };
        let finite = |x: f64| Some(x).filter(|x| x.is_finite());
        LoopGrowth {
            mean_square_radius: finite(radius),
            mean_square_growth: finite(radius).map(|_| growth),
            lyapunov_exponent: exponent.and_then(finite),
        }
    }
}
