//! Noise of a response.

use serde::Serialize;

/// The law of what a response has besides the effect of its commands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum NoiseKind {
    /// Independent errors of the measurements.
    White,
    /// Errors with an exponentially decaying correlation, besides independent ones.
    Coloured,
    /// A disturbance that acts on the plant like a command, besides independent errors of the measurements.
    Disturbance,
}

impl NoiseKind {
    /// All kinds, the simplest first.
    pub const ALL: [NoiseKind; 3] = [NoiseKind::White, NoiseKind::Coloured, NoiseKind::Disturbance];

    /// The name on the command line and in results.
    pub fn name(self) -> &'static str {
        match self {
            NoiseKind::White => "white",
            NoiseKind::Coloured => "coloured",
            NoiseKind::Disturbance => "disturbance",
        }
    }

    /// The name in sentences.
    pub fn in_words(self) -> &'static str {
        match self {
            NoiseKind::White => "white noise of the measurement",
            NoiseKind::Coloured => "coloured noise of the measurement",
            NoiseKind::Disturbance => {
                "a random disturbance of the plant and white noise of the measurement"
            }
        }
    }
}

/// Shares of the noise relative to the variance of its scale `σ²`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Noise {
    /// The variance of independent errors.
    pub(crate) white: f64,
    /// The variance of correlated errors.
    pub(crate) coloured: f64,
    /// Their correlation time, in s.
    pub(crate) correlation_time: f64,
    /// The intensity of the disturbance at the input of the plant.
    pub(crate) disturbance: f64,
}

impl Noise {
    pub(crate) const WHITE: Noise =
        Noise { white: 1.0, coloured: 0.0, correlation_time: 1.0, disturbance: 0.0 };

    /// Whether the states of the plant are random.
    pub(crate) fn moves_plant(&self) -> bool {
        self.disturbance > 0.0
    }
}
