//! The study `determinism`: changes that preserve results, and changes that do not.

mod claims;
mod invariance;
mod render;
mod runs;
mod sensitivity;
mod source_claims;
mod system;

use libration_report::Record;
use libration_report::page::Page;
use libration_report::record::RecordError;
use libration_study::{Lab, SourceClaim, Study, StudyError};

use self::source_claims::SOURCE_CLAIMS;
pub use self::system::SystemDeterminism;
use crate::bit_comparison;

/// The study `determinism`.
#[derive(Clone, Copy, Debug)]
pub struct Determinism;

impl Study for Determinism {
    fn name(&self) -> &'static str {
        "determinism"
    }

    fn question(&self) -> &'static str {
        "Which conditions change the bits of a result, and which do not?"
    }

    fn source_claims(&self) -> &'static [SourceClaim] {
        SOURCE_CLAIMS
    }

    fn run(&self, lab: &Lab<'_>) -> Result<Record, StudyError> {
        let mut record = Record::new(self.name(), self.question());
        bit_comparison::begin(&mut record);
        invariance::measure(lab, &mut record)?;
        sensitivity::measure(lab, &mut record)?;
        claims::judge(&mut record);
        Ok(record)
    }

    fn render(&self, record: &Record, page: &mut Page) -> Result<(), RecordError> {
        render::render(record, page)
    }
}
