//! Numbers with their intervals as text.

use libration_report::notation::number;

use crate::Estimate;

/// A number with its interval.
pub(crate) fn interval(estimate: Estimate, digits: usize) -> String {
    let Estimate { value, low, high } = estimate;
    format!("{} ({} to {})", number(value, digits), number(low, digits), number(high, digits))
}
