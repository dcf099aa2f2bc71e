//! Criteria for the largest time step.

/// The criteria of a request for the largest time step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Criteria {
    /// Largest relative energy drift.
    pub max_drift: Option<f64>,
    /// Largest length of `q`.
    pub max_amplitude: Option<f64>,
    /// Largest distance from the exact orbit, relative to its amplitude.
    pub max_error: Option<f64>,
}

impl Criteria {
    /// The flag of the first criterion.
    pub(crate) fn first(&self) -> Option<&'static str> {
        [
            (self.max_drift, "max-drift"),
            (self.max_amplitude, "max-amplitude"),
            (self.max_error, "max-error"),
        ]
        .into_iter()
        .find_map(|(value, flag)| value.map(|_| flag))
    }
}
