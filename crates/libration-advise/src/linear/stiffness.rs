//! Digits that the steps of a stiff plant lose.

use libration::linear::exponential_rounding;

use super::request::LinearRequest;

/// The largest relative rounding of a step that needs no warning. The text shows seven digits.
const MOST: f64 = 1e-9;

impl LinearRequest {
    /// A warning if rounding changes the matrix of a period by more than [`MOST`].
    pub(super) fn stiffness_warning(&self) -> Option<String> {
        let linear = &self.timed.linear;
        if linear.plant().sampling_period.is_some() {
            return None;
        }
        let rounding = exponential_rounding(&linear.plant().a.scaled(linear.period()));
        if !rounding.is_finite() {
            return Some("the plant moves so fast in a period that the matrix of a step cannot be computed; help: shorten the period".to_owned());
        }
        (rounding > MOST).then(|| format!(
            "the plant is stiff: rounding changes the matrix of its step by {rounding:.0e} of the largest entry, and the results by as much; help: give fast parts as [[part]], or states in which fast and slow motions are apart"
        ))
    }
}
