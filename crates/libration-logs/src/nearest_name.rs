//! Names that are similar to an unknown one.

/// Smallest similarity of a suggested name, between 0 and 1.
const NEAR: f64 = 0.6;

/// The candidates most similar to `name`, at most `count`, the nearest first.
///
/// A part between `/`, `.` and `_` suffices: `position` is similar to `/joint_states.position[3]`.
pub(crate) fn nearest<'a>(
    name: &str,
    candidates: impl Iterator<Item = &'a str>,
    count: usize,
) -> Vec<&'a str> {
    let name = name.to_lowercase();
    let likeness = |candidate: &str| {
        let lower = candidate.to_lowercase();
        let parts =
            lower.split(['/', '.', '[']).map(|part| 0.9 * strsim::jaro_winkler(&name, part));
        parts.fold(strsim::jaro_winkler(&name, &lower), f64::max)
    };
    let mut rated: Vec<(f64, &str)> = candidates
        .take(10_000)
        .map(|candidate| (likeness(candidate), candidate))
        .filter(|(likeness, _)| *likeness > NEAR)
        .collect();
    rated.sort_by(|a, b| b.0.total_cmp(&a.0));
    rated.truncate(count);
    rated.into_iter().map(|(_, candidate)| candidate).collect()
}
