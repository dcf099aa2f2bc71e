//! Stability margins in continuous time.

use libration_core::control::Feedback;
use libration_core::number::Wide;
use libration_core::{Elementary, Scalar};

use super::Plant;

impl Plant<'_> {
    /// The delay margin of the continuous loop that `feedback` closes: the latency in seconds at which it loses
    /// stability. None if it has none to lose, or loses it at no latency.
    pub fn delay_margin(&self, feedback: Feedback) -> Option<Wide> {
        let [kp, kd] = [feedback.position, feedback.velocity].map(Wide::from_f64);
        // q̈ = a_q·q + a_v·q̇ + u.
        let [aq, av] = [self.generator.entry(1, 0), self.generator.entry(1, 1)];
        let positive = |x: Wide| !x.is_negative() && !x.is_zero();
        if !(positive(kp - aq) && positive(kd - av)) {
            return None;
        }
        // With s = iΩ, |s² − a_v·s − a_q|² = |K_d·s + K_p|² is a quadratic in Ω².
        let half = (av * av + aq.scaled(1) - kd * kd).ratio(1, 2);
        let rest = aq * aq - kp * kp;
        let root = (half * half - rest).sqrt();
        // The larger root is where a pair of eigenvalues leaves.
        let square = root - half;
        if root.is_nan() || !positive(square) {
            return None;
        }
        let omega = square.sqrt();
        let a = [-square - aq, -av * omega];
        let b = [kp, kd * omega];
        let angle = (b[1] * a[0] - b[0] * a[1]).atan2(b[0] * a[0] + b[1] * a[1]) + Wide::pi();
        let turn = Wide::pi().scaled(1);
        let angle = if angle.is_negative() { angle + turn } else { angle };
        Some(angle / omega)
    }
}
