//! The stationary behaviour of a loop under noise.

/// The stationary behaviour of a loop under noise.
#[derive(Clone, Debug, PartialEq)]
pub struct Stationary {
    /// The cost per second; of a sampled plant per sample.
    pub cost: f64,
    /// The standard deviation of each state of the plant at the beginning of a period; under a schedule of controllers the rms over its periods.
    pub deviations: Vec<f64>,
}
