//! The study `storage`: speed and correctness of replay buffers, data sets and checkpoints.

mod claims;
mod figures;
mod files;
mod peers;
mod render;
mod ring_buffer;
mod sampling_cost;
mod settings;
mod source_claims;
mod speeds;

use libration_study::SourceClaim;

pub use self::settings::StorageSettings;
use self::source_claims::SOURCE_CLAIMS;
use libration_report::Record;
use libration_report::page::Page;
use libration_report::record::RecordError;
use libration_study::{Lab, Section, Study, StudyError};

/// The study `storage`.
#[derive(Clone, Copy, Debug)]
pub struct Storage;

impl Study for Storage {
    fn name(&self) -> &'static str {
        "storage"
    }

    fn measures_the_machine(&self) -> bool {
        true
    }

    fn question(&self) -> &'static str {
        "How fast are replay buffers, data sets and checkpoints, and do they preserve every byte?"
    }

    fn source_claims(&self) -> &'static [SourceClaim] {
        SOURCE_CLAIMS
    }

    fn settings(&self) -> Option<Section> {
        Some(Section::of::<StorageSettings>())
    }

    fn run(&self, lab: &Lab<'_>) -> Result<Record, StudyError> {
        let mut record = Record::new(self.name(), self.question());
        let parts: [(&str, Part); 5] = [
            ("a circle", ring_buffer::measure),
            ("draws", sampling_cost::measure),
            ("files", files::measure),
            ("speeds", speeds::measure),
            ("peers", peers::measure),
        ];
        for (what, part) in parts {
            lab.part(what, || part(lab, &mut record))?;
        }
        claims::judge(&mut record);
        Ok(record)
    }

    fn render(&self, record: &Record, page: &mut Page) -> Result<(), RecordError> {
        render::render(record, page)
    }
}

/// A part of the study.
type Part = fn(&Lab<'_>, &mut Record) -> Result<(), StudyError>;

/// The folder in which the study may make one of its own.
fn folder(lab: &Lab<'_>) -> std::path::PathBuf {
    lab.config.get::<StorageSettings>().folder.clone().unwrap_or_else(std::env::temp_dir)
}
