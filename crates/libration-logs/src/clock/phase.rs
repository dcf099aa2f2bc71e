//! What a latency costs a loop, whatever its plant.

use serde::Serialize;

/// A phase lag at a frequency.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PhaseLag {
    /// The frequency in Hz.
    pub frequency: f64,
    /// The lag in degrees.
    pub degrees: f64,
}

/// Frequencies in Hz.
const FREQUENCIES: [f64; 7] = [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0];
/// Largest lag that is listed, in degrees.
const MOST: f64 = 360.0;

/// The phase lags `360° · f · latency` of a latency in s.
pub fn phase_lags(latency: f64) -> Vec<PhaseLag> {
    let lags =
        FREQUENCIES.map(|frequency| PhaseLag { frequency, degrees: 360.0 * frequency * latency });
    lags.into_iter().filter(|lag| lag.degrees <= MOST).collect()
}

/// The frequency in Hz at which a latency in s costs so many degrees; none without a latency.
pub fn rate_of_phase(latency: f64, degrees: f64) -> Option<f64> {
    (latency > 0.0).then(|| degrees / (360.0 * latency))
}
