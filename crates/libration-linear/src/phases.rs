//! The phases of a period at which something happens, from 0 to 1.

/// Whether two phases differ by rounding only: then a measurement comes before a command.
pub(crate) fn same(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-12
}

/// Phases in order, each once.
pub(crate) fn merged(mut phases: Vec<f64>) -> Vec<f64> {
    phases.sort_by(f64::total_cmp);
    // The first stays: 0 in place of what rounding leaves of it.
    phases.dedup_by(|later, earlier| same(*later, *earlier));
    if let Some(last) = phases.last_mut().filter(|last| same(**last, 1.0)) {
        *last = 1.0;
    }
    phases
}
