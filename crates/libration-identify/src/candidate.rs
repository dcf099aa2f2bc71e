//! Tried models.

use serde::Serialize;

use crate::arrivals::{ArrivalFit, ArrivalLaw};
use crate::estimate::Estimate;
use crate::hold::Hold;
use crate::noise::NoiseKind;

/// A tried model.
#[derive(Clone, Debug, Serialize)]
pub struct CandidateRow {
    /// The name of the form of the response.
    pub response: &'static str,
    /// What the receiver makes of commands between their times.
    pub hold: Hold,
    /// The kind of noise.
    pub noise: NoiseKind,
    /// How commands arrive: `certain`, `jitter`, `loss` or `two-delays`.
    pub arrivals: &'static str,
    /// The dead time in s; the shorter one of two.
    pub dead_time: f64,
    /// The second parameter: lag or time constant in s.
    pub second: Option<f64>,
    /// The number of estimated numbers.
    pub parameters: usize,
    /// The log likelihood.
    pub log_likelihood: f64,
    /// Bayes' information criterion less that of the best model.
    pub excess: f64,
}

impl CandidateRow {
    /// The row of a model in which all commands arrive.
    pub(crate) fn certain(estimate: &Estimate<'_>) -> Self {
        CandidateRow {
            response: estimate.model.response.name(),
            hold: estimate.model.hold,
            noise: estimate.model.noise,
            arrivals: ArrivalLaw::Certain.name(),
            dead_time: estimate.point.shape[0],
            second: estimate.point.shape.get(1).copied(),
            parameters: estimate.parameters(),
            log_likelihood: estimate.log_likelihood,
            excess: estimate.criterion(),
        }
    }

    /// The row of a law of arrivals, by its gain over `certain` arrivals in the same filter.
    pub(crate) fn random(base: &Estimate<'_>, fit: &ArrivalFit, certain: &ArrivalFit) -> Self {
        let count = base.regression.residuals.len();
        let gained = certain.criterion(count) - fit.criterion(count);
        CandidateRow {
            arrivals: fit.law.name(),
            dead_time: fit.model.shape[0],
            second: fit.model.shape.get(1).copied(),
            parameters: fit.parameters,
            log_likelihood: base.log_likelihood + fit.log_likelihood - certain.log_likelihood,
            excess: base.criterion() - gained,
            ..CandidateRow::certain(base)
        }
    }
}
