//! The largest stable time step: windows, criteria, horizons.

mod claims;
mod curves;
mod largest;
mod render;
mod settings;
mod source_claims;
mod system;
mod system_page;
mod system_tables;
mod windows;

use libration_study::SourceClaim;

pub use self::settings::StabilitySettings;
use self::source_claims::SOURCE_CLAIMS;
pub use self::system::SystemStability;
use libration_report::Record;
use libration_report::page::Page;
use libration_report::record::RecordError;
use libration_study::{Lab, Section, Study, StudyError};

/// The study `stability`.
#[derive(Clone, Copy, Debug)]
pub struct Stability;

impl Study for Stability {
    fn name(&self) -> &'static str {
        "stability"
    }

    fn question(&self) -> &'static str {
        "How large may a time step be, by which definition of “stable”?"
    }

    fn source_claims(&self) -> &'static [SourceClaim] {
        SOURCE_CLAIMS
    }

    fn settings(&self) -> Option<Section> {
        Some(Section::of::<StabilitySettings>())
    }

    fn run(&self, lab: &Lab<'_>) -> Result<Record, StudyError> {
        let mut record = Record::new(self.name(), self.question());
        windows::measure(lab, &mut record)?;
        largest::measure(lab, &mut record)?;
        curves::draw(lab, &mut record)?;
        curves::crossovers(lab, &mut record)?;
        claims::judge(lab.config, &mut record);
        Ok(record)
    }

    fn render(&self, record: &Record, page: &mut Page) -> Result<(), RecordError> {
        render::render(record, page)
    }
}
