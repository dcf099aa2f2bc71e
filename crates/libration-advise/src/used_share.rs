//! The used share of a budget in words.

/// The used part of a budget, with one decimal; beyond ten times with three digits.
pub(crate) fn share_in_percent(used: f64) -> String {
    let percent = 100.0 * used;
    match percent {
        all if all >= 1e6 => format!("{all:.2e} %"),
        all if all >= 1e3 => format!("{all:.0} %"),
        part => format!("{part:.1} %"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn used_parts_have_no_digits_without_meaning() {
        for (used, text) in [
            (0.13049, "13.0 %"),
            (1.305, "130.5 %"),
            (25.678, "2568 %"),
            (1.32034980283e8, "1.32e10 %"),
        ] {
            assert_eq!(share_in_percent(used), text);
        }
    }
}
