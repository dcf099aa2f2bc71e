//! What to do about orders.

use libration::Method;
use libration_report::notation::number;
use libration_report::page::Page;
use libration_report::record::Record;

/// Adds the actions, for the named systems: of the configuration, or the user's own.
pub(super) fn add(record: &Record, systems: &[(String, String)], is_own: bool, page: &mut Page) {
    let least = |method: Method| {
        let order = |(system, _): &(String, String)| {
            let id = format!("convergence.{system}.{}.global-order", method.name());
            record.finding(&id).ok().map(|f| f.measured)
        };
        systems.iter().filter_map(order).reduce(f64::min)
    };
    let orders = Method::ALL.into_iter().filter_map(|m| Some((m, least(m)?)));
    if let Some((method, order)) = orders.max_by(|a, b| a.1.total_cmp(&b.1)) {
        page.action(format!(
            "Use {} for small errors: half the time step divides its error by {}.",
            method.title(),
            number(order.exp2(), 2)
        ));
    }
    page.action(match is_own {
        true => "Compare it with published methods at equal work: `libration analyze --system FILE --compare --tolerance 1e-4 --horizon 10`.",
        false => "Measure the orders on your system before you rely on them: `libration lab --system FILE convergence`.",
    });
    if record.series("trap").is_ok() {
        page.action(
            "Fit orders to positions and velocities together. From a start without force, positions alone show a wrong order.",
        );
    }
}
