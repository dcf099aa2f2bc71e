//! Findings about changed runs and the number of different results, also as rows of a table.

use libration_report::record::{Cell, Finding, Record, RecordError, Table};

const NAME: &str = "what is changed";

/// Adds the empty table.
pub(super) fn begin(record: &mut Record) {
    record.tables.push(Table::new(NAME, &["changed", "compared", "differ"]));
}

/// Adds a finding with the number of different results, and a row to the table.
pub(super) fn add_row(record: &mut Record, changed: &str, compared: usize, finding: Finding) {
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
