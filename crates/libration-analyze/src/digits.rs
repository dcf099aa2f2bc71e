//! Numbers in the evidence of verdicts.

/// A number with at most so many digits, without zeros at its end.
pub(crate) fn significant(x: f64, digits: usize) -> String {
    // Rounded in decimal, so that its shortest form has no more digits.
    let rounded: f64 = format!("{x:.*e}", digits - 1).parse().unwrap_or(x);
    let text = format!("{rounded:?}");
    text.strip_suffix(".0").map_or(text.clone(), str::to_owned)
}

/// A number by its difference from one: `1 + 0.05`.
pub fn beside_one(difference: f64) -> String {
    match difference {
        // Rounding of eigenvalues.
        x if x.abs() < 1e-15 => "1".to_owned(),
        x => format!("1 {} {}", if x < 0.0 { "−" } else { "+" }, significant(x.abs(), 5)),
    }
}

/// A relative change per step, in words.
pub fn change_per_step(change: f64) -> String {
    let percent = significant(100.0 * change.abs(), 4);
    match (change > 0.0, change < 0.0) {
        (true, _) if change.is_infinite() => "grow beyond the range of floats in a step".to_owned(),
        (true, _) => format!("grow by {percent} % per step"),
        (_, true) => format!("decay by {percent} % per step"),
        _ => "neither grow nor decay".to_owned(),
    }
}
