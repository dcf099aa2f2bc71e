//! Orders of single states, by their names.

use libration_report::record::{Cell, Record, Relation, Table};

use super::Case;
use crate::subject::{Errors, StudiedState};

/// The name of the table of a system.
pub(super) fn table_name(system: &str) -> String {
    format!("states-{system}")
}

/// Adds the orders of all states of each system, to which `methods` cases belong.
pub(super) fn find(
    cases: &[Case<'_>],
    errors: &[[Errors; 2]],
    methods: usize,
    record: &mut Record,
) {
    let methods = methods.max(1);
    for (cases, errors) in cases.chunks(methods).zip(errors.chunks(methods)) {
        let Some(system) = cases.first().map(|case| case.subject) else { continue };
        let titles = cases.iter().map(|case| case.method.title());
        let columns: Vec<&str> = ["state"].into_iter().chain(titles).collect();
        let mut table = Table::new(&table_name(system.name()), &columns);
        for (i, state) in system.states().iter().enumerate() {
            let orders = cases.iter().zip(errors);
            let cells: Vec<Cell> =
                orders.map(|(case, [global, _])| case.state_order(i, global, record)).collect();
            table.push([Cell::from(named(state))].into_iter().chain(cells));
        }
        record.tables.push(table);
    }
}

impl Case<'_> {
    /// Adds the order of state `i`, which theory bounds from below: in a single state the leading term of the error may vanish.
    fn state_order(&self, i: usize, errors: &Errors, record: &mut Record) -> Cell {
        let (system, method) = (self.subject, self.method);
        let state = &system.states()[i];
        let Some(fit) = self.fit(errors, &errors.states[i]) else {
            return Cell::absent("exact to rounding, or not finite");
        };
        let id =
            format!("convergence.{}.{}.state-order.{}", system.name(), method.name(), state.place);
        let text = format!(
            "{}, {}: exponent of Δt in the error of {} over more than half a turn",
            method.title(),
            system.title(),
            state.name
        );
        let points = [&errors.dt[..], &errors.states[i]];
        let order = self.order.map(f64::from);
        record.find(self.judge((id, text), order, Relation::AtLeast, fit, points));
        fit.exponent.into()
    }
}

/// A state with its unit.
fn named(StudiedState { name, unit, .. }: &StudiedState) -> String {
    if unit.is_empty() { name.clone() } else { format!("{name} ({unit})") }
}
