//! What to do about energy drift.

use libration_report::notation::{number, seconds};
use libration_report::page::Page;
use libration_report::record::Record;

use super::tag;

/// Adds the actions, for the smallest time step.
pub(super) fn add(record: &Record, dt: f64, page: &mut Page) {
    let crossover = format!("drift.crossover.{}.leading-order", tag(dt));
    if let Ok(crossover) = record.finding(&crossover) {
        page.action(format!(
            "At Δt = {} take RK4 for runs of up to {} steps, and velocity Verlet for longer ones.",
            seconds(dt, 3),
            number(crossover.measured, 2)
        ));
    }
    page.action(
        "Audit the energy of your simulator at two time steps: `libration audit h1.csv h2.csv --energy E`. \
         It separates oscillation, drift, rounding and wrong forces.",
    );
}
