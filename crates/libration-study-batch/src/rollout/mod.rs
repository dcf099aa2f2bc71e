//! The study `rollout`: rates of rollouts and the reproducibility of their bits.

mod advantages;
mod affine_cost;
mod cases;
mod claims;
mod figures;
mod fresh_memory;
mod invariance;
mod layout;
mod peers;
mod render;
mod scaling;
mod scaling_limit;
mod settings;
mod source_claims;
mod source_table;
mod summary;

use libration_study::SourceClaim;

pub use self::settings::RolloutSettings;
use self::source_claims::SOURCE_CLAIMS;
use libration_report::Record;
use libration_report::page::Page;
use libration_report::record::RecordError;
use libration_study::{Lab, Section, Study, StudyError};

use crate::measurement::Measurement;

/// The study `rollout`.
#[derive(Clone, Copy, Debug)]
pub struct Rollout;

impl Study for Rollout {
    fn name(&self) -> &'static str {
        "rollout"
    }

    fn measures_the_machine(&self) -> bool {
        true
    }

    fn question(&self) -> &'static str {
        "How fast are rollouts of many environments, what limits them, and which settings change \
         their bits?"
    }

    fn source_claims(&self) -> &'static [SourceClaim] {
        SOURCE_CLAIMS
    }

    fn settings(&self) -> Option<Section> {
        Some(Section::of::<RolloutSettings>())
    }

    fn run(&self, lab: &Lab<'_>) -> Result<Record, StudyError> {
        let measurement = Measurement::new(lab)?;
        let mut record = Record::new(self.name(), self.question());
        let parts: [(&str, Part); 7] = [
            ("layouts and ways to write", cases::measure),
            ("environments and horizons", scaling::measure),
            ("fresh memory", fresh_memory::measure),
            ("advantages", advantages::measure),
            ("bits", invariance::measure),
            ("layout", layout::measure),
            ("peers", peers::measure),
        ];
        for (what, part) in parts {
            lab.part(what, || part(&measurement, &mut record))?;
        }
        source_table::check(&mut record);
        scaling_limit::detect(&mut record)?;
        summary::compare(lab, &mut record)?;
        claims::judge(&mut record);
        Ok(record)
    }

    fn render(&self, record: &Record, page: &mut Page) -> Result<(), RecordError> {
        render::render(record, page)
    }
}

/// A part of the study.
type Part = fn(&Measurement<'_>, &mut Record) -> Result<(), StudyError>;
