//! The settings of the source report.

use crate::Config;

/// Time step (§4.3 and the numbers of §9.2) in s.
pub const DT: f64 = 1e-3;

/// Number of steps.
pub const STEPS: u64 = 1_000_000;

/// ω² in s⁻².
pub const OMEGA2: f64 = 10.0;

/// Whether spring and start are those of the source: ω² = 10 s⁻², from (1, 0).
pub fn is_source_orbit(config: &Config) -> bool {
    config.oscillator.system().omega2 == OMEGA2 && (config.start.q, config.start.v) == (1.0, 0.0)
}
