//! The chapter on precision.

use crate::page::Page;
use crate::record::{Record, RecordError};

pub(super) fn render(record: &Record, page: &mut Page) -> Result<(), RecordError> {
    page.title = "Precision".into();
    for table in &record.tables {
        page.table(table, 3);
    }
    Ok(())
}
