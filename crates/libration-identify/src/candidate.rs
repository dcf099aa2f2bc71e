//! Tried models.

use serde::Serialize;

use crate::estimate::Estimate;
use crate::hold::Hold;
use crate::noise::NoiseKind;

/// A tried form of response and noise.
#[derive(Clone, Debug, Serialize)]
pub struct CandidateRow {
    /// The name of the form of the response.
    pub response: &'static str,
    /// What the receiver makes of commands between their times.
    pub hold: Hold,
    /// The kind of noise.
    pub noise: NoiseKind,
    /// The dead time in s.
    pub dead_time: f64,
    /// The second parameter: lag or time constant in s.
    pub second: Option<f64>,
    /// The number of estimated numbers.
    pub parameters: usize,
    /// The log likelihood.
    pub log_likelihood: f64,
    /// How much larger Bayes' information criterion is than that of the best form.
    pub excess: f64,
}

impl CandidateRow {
    pub(crate) fn new(estimate: &Estimate, best: f64) -> Self {
        CandidateRow {
            response: estimate.model.response.name(),
            hold: estimate.model.hold,
            noise: estimate.model.noise,
            dead_time: estimate.point.shape[0],
            second: estimate.point.shape.get(1).copied(),
            parameters: estimate.parameters(),
            log_likelihood: estimate.log_likelihood,
            excess: estimate.criterion() - best,
        }
    }
}

/// A tried law of arrivals.
#[derive(Clone, Debug, Serialize)]
pub struct ArrivalRow {
    /// `certain`, `jitter`, `loss` or `two-delays`.
    pub law: &'static str,
    /// What it adds, by key.
    pub parameters: Vec<(String, f64)>,
    /// The log likelihood.
    pub log_likelihood: f64,
    /// How much larger Bayes' information criterion is than that of the best law.
    pub excess: f64,
}
