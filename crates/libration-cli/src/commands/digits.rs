//! Numbers in answers: as many digits as mean something to a reader. JSON has all of them.

use libration_report::notation::{cut_off, cut_up};

/// Text in place of a result that exact arithmetic cannot derive.
pub(super) const UNKNOWN: &str = "not known: the polynomials of this step outgrow exact arithmetic";

/// A number with at most ten digits, without zeros at its end.
pub(super) fn short(x: f64) -> String {
    significant(x, 10)
}

/// A number with at most so many digits, without zeros at its end.
pub(super) fn significant(x: f64, digits: usize) -> String {
    // Rounded in decimal, so that its shortest form has no more digits.
    exact(format!("{x:.*e}", digits - 1).parse().unwrap_or(x))
}

/// A limit with at most so many digits, not beyond itself: cut off behind the twelve digits that a search has.
pub(super) fn limit(x: f64, digits: usize) -> String {
    exact(cut_off(x, digits))
}

/// A lower limit with at most so many digits, not below itself.
pub(super) fn least(x: f64, digits: usize) -> String {
    exact(cut_up(x, digits))
}

/// A limit with all its digits: rounded, it might be beyond itself.
pub(super) fn exact(x: f64) -> String {
    let text = format!("{x:?}");
    text.strip_suffix(".0").map_or(text.clone(), str::to_owned)
}

/// A number near one, with its difference from one, which may be far below the last digit.
pub(super) fn beside_one(x: f64, difference: f64) -> String {
    if difference == 0.0 { "1".to_owned() } else { format!("{}  (1 {difference:+.6e})", short(x)) }
}

/// A sum of terms without those that are zero, such as `0.5 v² + 5 q²`; `0` if all are.
pub(super) fn sum(terms: &[(f64, &str)]) -> String {
    let mut text = String::new();
    for &(factor, of) in terms.iter().filter(|(factor, _)| *factor != 0.0) {
        let sign = if factor < 0.0 { "−" } else { "+" };
        text += &match (text.is_empty(), factor < 0.0) {
            (true, false) => format!("{} {of}", short(factor)),
            (true, true) => format!("−{} {of}", short(-factor)),
            (false, _) => format!(" {sign} {} {of}", short(factor.abs())),
        };
    }
    if text.is_empty() { "0".to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_at_most_ten_digits_and_no_zeros_at_the_end() {
        for (x, text) in [
            (1.0, "1"),
            (0.5, "0.5"),
            (0.9995000416652778, "0.9995000417"),
            (0.1 + 0.2, "0.3"),
            (-15.324841096092163, "-15.3248411"),
            (3.967187110845871e-294, "3.967187111e-294"),
            (1e20, "1e20"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(short(x), text);
        }
    }

    #[test]
    fn limits_of_few_digits_are_not_beyond_themselves() {
        for (x, text) in [
            (0.15324841096092163, "0.1532"),
            (0.89449999, "0.8944"),
            (-0.69999, "-0.6999"),
            (0.3, "0.3"),
            (2.0 - 1e-15, "2"),
            (1.23456e-9, "1.234e-9"),
            (0.0, "0"),
        ] {
            assert_eq!(limit(x, 4), text);
        }
        // The factor of all imperfections of a public case, whose rounded form is unstable.
        assert_eq!((limit(3.135_90, 4), least(3.135_90, 4)), ("3.135".into(), "3.136".into()));
        assert_eq!((limit(4.231_648, 4), limit(50.416_18, 4)), ("4.231".into(), "50.41".into()));
    }

    #[test]
    fn what_is_zero_is_left_out() {
        assert_eq!(sum(&[(0.5, "v²"), (0.0, "q v"), (4.99875, "q²")]), "0.5 v² + 4.99875 q²");
        assert_eq!(sum(&[(-1.0, "v²"), (-0.25, "q v")]), "−1 v² − 0.25 q v");
        assert_eq!(sum(&[(0.0, "v²")]), "0");
        assert_eq!(beside_one(1.0, 0.0), "1");
        assert_eq!(
            beside_one(1.0005422962608295, 5.422962608294426e-4),
            "1.000542296  (1 +5.422963e-4)"
        );
        // A difference that the number does not show.
        assert_eq!(beside_one(1.0, 1e-30), "1  (1 +1.000000e-30)");
    }
}
