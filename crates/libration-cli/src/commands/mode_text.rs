//! Text of modes: counts, shapes, and numbers that may be unknown.

/// A number of things.
pub(super) fn counted(count: usize, noun: &str) -> String {
    let plural = if count == 1 { "" } else { "s" };
    format!("{count} {noun}{plural}")
}

/// Names of states with their sizes relative to the largest.
pub(super) fn shape(states: &[(String, f64)]) -> String {
    let each = states.iter().map(|(name, share)| match share {
        share if *share > 0.995 => name.clone(),
        share => format!("{share:.2} {name}"),
    });
    each.collect::<Vec<_>>().join(", ")
}

/// A number if it is known.
pub(super) fn known(x: Option<f64>, digits: usize) -> String {
    x.map_or_else(|| "none".to_owned(), |x| format!("{x:.digits$}"))
}
