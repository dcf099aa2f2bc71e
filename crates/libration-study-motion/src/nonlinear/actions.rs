//! What to do about energy in nonlinear motion.

use libration::Method;
use libration_report::page::Page;
use libration_report::record::Record;

/// The exponent of time in a drift below which it does not grow: half of that of a random walk.
const CONSTANT: f64 = 0.25;

/// Adds the actions, for systems of the configuration or the user's own.
pub(super) fn add(record: &Record, is_own: bool, page: &mut Page) {
    let bounded: Vec<&str> =
        Method::ALL.into_iter().filter(|m| is_bounded(record, *m)).map(|m| m.title()).collect();
    if !bounded.is_empty() {
        page.action(format!(
            "Take an integrator for long runs whose energy drift does not grow: {}.",
            bounded.join(", ")
        ));
    }
    page.action(match is_own {
        true => "Find the time step for an energy error: `libration advise --system FILE --tolerance energy=1e-6 --horizon 10`.",
        false => "Search the largest step from the start of your motion, since large motion may need smaller steps: `libration lab --system FILE nonlinear`.",
    });
}

/// Whether theory predicts a constant drift of the method on a system, and no system contradicts it.
fn is_bounded(record: &Record, method: Method) -> bool {
    let end = format!(".{}.growth", method.name());
    let mut growths = record.findings.iter().filter(|f| f.id.ends_with(&end)).peekable();
    let is_promised = growths.clone().any(|f| f.predicted == Some(0.0));
    is_promised && growths.all(|f| f.measured < CONSTANT)
}
