//! What to do about orders.

use libration::Method;
use libration_report::notation::number;
use libration_report::page::Page;
use libration_report::record::Record;

/// The difference of fitted orders below which they count as one.
const SAME: f64 = 0.5;

/// Adds the actions, for the named systems: of the configuration, or the user's own.
pub(super) fn add(record: &Record, systems: &[(String, String)], is_own: bool, page: &mut Page) {
    let least = |method: Method| {
        let order = |(system, _): &(String, String)| {
            let id = format!("convergence.{system}.{}.global-order", method.name());
            record.finding(&id).ok().map(|f| f.measured)
        };
        systems.iter().filter_map(order).reduce(f64::min)
    };
    let orders: Vec<(Method, f64)> =
        Method::ALL.into_iter().filter_map(|m| Some((m, least(m)?))).collect();
    let highest = orders.iter().map(|(_, order)| *order).fold(f64::NAN, f64::max);
    let (high, low): (Vec<_>, Vec<_>) = orders.iter().partition(|(_, p)| *p > highest - SAME);
    // Without a lower order there is no choice.
    if let (Some(order), false) = (high.iter().map(|(_, p)| *p).reduce(f64::min), low.is_empty()) {
        let titles: Vec<&str> = high.iter().map(|(m, _)| m.title()).collect();
        page.action(format!(
            "Take an integrator of high order for small errors: {}. Half the time step divides its error by {}.",
            titles.join(", "),
            number(order.exp2(), 2)
        ));
    }
    page.action(match is_own {
        true => "Compare integrators with published methods at equal work: `libration analyze --system FILE --compare --tolerance 1e-4 --horizon 10`.",
        false => "Measure the orders on your system before you rely on them: `libration lab --system FILE convergence`.",
    });
    if record.series("trap").is_ok() {
        page.action(
            "Fit orders to positions and velocities together. From a start without force, positions alone show a wrong order.",
        );
    }
}
