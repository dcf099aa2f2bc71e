//! What bits depend on: what may be changed without another result, and what may not.

mod broken;
mod claims;
mod kept;
mod render;
mod runs;

use crate::page::Page;
use crate::record::RecordError;
use crate::studies::changed;
use crate::study::{Study, StudyError};
use crate::{Lab, Record};

/// The study `determinism`.
#[derive(Clone, Copy, Debug)]
pub struct Determinism;

impl Study for Determinism {
    fn name(&self) -> &'static str {
        "determinism"
    }

    fn question(&self) -> &'static str {
        "What does a result depend on, to the bit, and what not?"
    }

    fn run(&self, lab: &Lab<'_>) -> Result<Record, StudyError> {
        let mut record = Record::new(self.name(), self.question());
        changed::begin(&mut record);
        kept::measure(lab, &mut record)?;
        broken::measure(lab, &mut record)?;
        claims::judge(&mut record);
        Ok(record)
    }

    fn render(&self, record: &Record, page: &mut Page) -> Result<(), RecordError> {
        render::render(record, page)
    }
}
