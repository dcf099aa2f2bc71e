//! The chapter on throughput.

use crate::page::Page;
use crate::record::{Record, RecordError};

/// Writes the chapter.
pub(super) fn render(record: &Record, page: &mut Page) -> Result<(), RecordError> {
    page.title = "Throughput".into();
    for table in &record.tables {
        page.heading(&table.name);
        page.table(table, 3);
    }
    Ok(())
}
