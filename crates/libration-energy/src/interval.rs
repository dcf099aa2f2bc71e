//! Numbers with their intervals as text.

use libration_report::notation::number;

use crate::Estimate;

/// Exponents below this are 0.00.
const ZERO: f64 = 0.005;

/// A number with its interval.
pub fn interval(estimate: Estimate, digits: usize) -> String {
    text(estimate, |x| number(x, digits))
}

/// An exponent with its interval; `0.00` for one that is zero within rounding.
pub fn exponent(estimate: Estimate) -> String {
    text(estimate, |x| if x.abs() < ZERO { "0.00".to_owned() } else { number(x, 3) })
}

fn text(Estimate { value, low, high }: Estimate, number: impl Fn(f64) -> String) -> String {
    match high.is_infinite() {
        true => format!("{} (no interval)", number(value)),
        false => format!("{} ({} to {})", number(value), number(low), number(high)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponents_of_zero_and_infinite_intervals_are_read_as_such() {
        let zero = Estimate { value: 3e-11, low: -0.004, high: 0.12 };
        assert_eq!(exponent(zero), "0.00 (0.00 to 0.12)");
        assert_eq!(interval(Estimate::unbounded(0.25), 3), "0.25 (no interval)");
    }
}
