//! Claims of chapters 5 and 8 and of section 9.4.

use crate::record::Record;

/// Judges them from the findings of the record.
pub(super) fn judge(_record: &mut Record) {}
