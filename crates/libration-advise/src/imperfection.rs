//! Timing imperfections of a loop.

/// A timing imperfection of a loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Imperfection {
    /// Latency of commands, in periods of the loop.
    Latency,
    /// Latency of measurements, in periods of the loop.
    OutputLatency,
    /// Independent jitter of sample times, as relative rms.
    Jitter,
    /// Relative error of the period, to the stated side: slow or fast.
    Skew,
    /// Loss of commands, as a probability.
    Loss,
}

impl Imperfection {
    /// The name in output.
    pub fn name(self) -> &'static str {
        match self {
            Imperfection::Latency => "latency",
            Imperfection::OutputLatency => "output latency",
            Imperfection::Jitter => "jitter",
            Imperfection::Skew => "clock",
            Imperfection::Loss => "lost commands",
        }
    }
}
