//! How fast the plant of a loop moves.

use num_complex::Complex64;

use crate::LinearLoop;

/// Decay within a period after which a motion no longer counts, `−ln` of a rounding.
const FORGOTTEN: f64 = 37.0;

impl LinearLoop {
    /// The fastest motion of the plant in rad/s, of those that decay by less than `e^−decay` in a period.
    fn fastest(&self, decay: f64) -> f64 {
        let lasts = |motion: &&Complex64| motion.re * self.period() > -decay;
        self.motions().iter().filter(lasts).map(|motion| motion.norm()).fold(0.0, f64::max)
    }

    /// The fastest motion of the plant that lasts for about a period, in rad/s.
    pub fn rate(&self) -> f64 {
        self.fastest(1.0)
    }

    /// The fastest motion of the plant that rounding does not lose in a period, in rad/s.
    pub(crate) fn smooth_rate(&self) -> f64 {
        self.fastest(FORGOTTEN)
    }
}
