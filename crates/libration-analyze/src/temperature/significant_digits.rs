//! Numbers of five significant digits in text.

/// A number rounded to five significant digits: a decimal from 0.0001 to 10 million, scientific beyond.
pub fn significant(x: f64) -> String {
    let rounded: f64 = format!("{x:.4e}").parse().unwrap_or(x);
    match rounded == 0.0 || !rounded.is_finite() || (1e-4..1e7).contains(&rounded.abs()) {
        true => format!("{rounded}"),
        false => format!("{rounded:e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_five_digits_at_any_size() {
        for (x, text) in [
            (0.0, "0"),
            (2.0, "2"),
            (0.632_455_5, "0.63246"),
            (-123_456.0, "-123460"),
            (4.1e-21, "4.1e-21"),
            (1e300, "1e300"),
            (9.999_99e6, "1e7"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(significant(x), text);
        }
    }
}
