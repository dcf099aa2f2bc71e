//! Numbers of three digits in messages.
//!
//! It uses nothing of the crate: the tests of `tests/analyze` compile it alone, in place of the whole crate once more.

/// A positive number rounded to three digits.
pub(super) fn short(x: f64) -> String {
    digits(x, f64::round)
}

/// A positive number rounded down to three digits.
pub(super) fn short_below(x: f64) -> String {
    digits(x, f64::floor)
}

/// A positive number rounded up to three digits.
pub(super) fn short_above(x: f64) -> String {
    digits(x, f64::ceil)
}

fn digits(x: f64, round: fn(f64) -> f64) -> String {
    if !(1e-290..1e290).contains(&x) {
        return format!("{x:?}");
    }
    let exponent = x.log10().floor() as i32 - 2;
    let number = round(x / 10.0_f64.powi(exponent));
    // Parsing the decimal keeps its digits.
    let rounded: f64 = format!("{number}e{exponent}").parse().unwrap_or(x);
    if (1e-4..1e7).contains(&rounded) { format!("{rounded}") } else { format!("{rounded:e}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_digits_and_bounds_lie_on_the_side_that_they_name() {
        for (x, rounded, below, above) in [
            (2.0, "2", "2", "2"),
            (0.632_455_5, "0.632", "0.632", "0.633"),
            (2.828_427_1, "2.83", "2.82", "2.83"),
            (1.573_4, "1.57", "1.57", "1.58"),
            (12_345.0, "12300", "12300", "12400"),
            (6.329e-9, "6.33e-9", "6.32e-9", "6.33e-9"),
            (9.999, "10", "9.99", "10"),
        ] {
            assert_eq!((&*short(x), &*short_below(x), &*short_above(x)), (rounded, below, above));
        }
    }
}
