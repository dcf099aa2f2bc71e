//! What was changed about a run, and how much of its result differs: findings that are rows of a table, too.

use libration_report::record::{Cell, Finding, Record, RecordError, Table};

const NAME: &str = "what is changed";

/// Adds the empty table.
pub(super) fn begin(record: &mut Record) {
    record.tables.push(Table::new(NAME, &["changed", "compared", "differ"]));
}

/// Leaves a finding of how many of those that were compared differ, and a row in the table.
pub(super) fn tell(record: &mut Record, changed: &str, compared: usize, finding: Finding) {
    let row: [Cell; 3] =
        [changed.into(), (compared as u64).into(), (finding.measured as u64).into()];
    record.find(finding);
    if let Some(table) = record.tables.iter_mut().find(|table| table.name == NAME) {
        table.push(row);
    }
}

/// The table.
pub(super) fn table(record: &Record) -> Result<&Table, RecordError> {
    record.table(NAME)
}
