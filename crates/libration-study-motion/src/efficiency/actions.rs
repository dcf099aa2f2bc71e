//! What to do about the cost of an accuracy.

use libration_report::page::Page;
use libration_report::record::{Cell, Table};

/// The tolerances that `libration analyze --compare` accepts.
const TOLERANCES: std::ops::RangeInclusive<f64> = 1e-13..=0.1;

/// Adds the actions, from the table of the cheapest methods and a tolerance of it.
pub(super) fn add(answers: &Table, tolerance: &str, page: &mut Page) {
    let text = |cell: &Cell| cell.typeset(3);
    let rows = || answers.rows.iter().filter(|row| text(&row[1]) == tolerance);
    let value = rows().find_map(|row| row[1].value());
    if let Some(value) = value.filter(|value| TOLERANCES.contains(value)) {
        page.action(format!(
            "Find the cheapest integrator for your system: `libration analyze --system FILE --compare --tolerance {value:e} --horizon 10`."
        ));
    }
    let cheapest = |kind: &str| rows().rfind(|row| text(&row[0]) == kind).map(|row| text(&row[3]));
    if let (Some(energy), Some(state)) = (cheapest("energy"), cheapest("state"))
        && energy != state
    {
        page.action(format!(
            "Decide whether you need the energy or the state: {energy} is cheapest for the energy, {state} for the state."
        ));
    }
}
