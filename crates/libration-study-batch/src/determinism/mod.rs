//! What bits depend on: what may be changed without another result, and what may not.

mod broken;
mod claims;
mod kept;
mod render;
mod runs;
mod tried;

use libration_report::Record;
use libration_report::page::Page;
use libration_report::record::RecordError;
use libration_study::{Lab, Study, StudyError, Tried};

use self::tried::TRIED;
use crate::changed;

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

    fn tries(&self) -> &'static [Tried] {
        TRIED
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
