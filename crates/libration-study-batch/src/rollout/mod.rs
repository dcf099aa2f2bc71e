//! How fast rollouts of many environments are written, and what their bits depend on.

mod advantages;
mod cases;
mod claims;
mod figures;
mod fresh;
mod kept;
mod layout;
mod line;
mod peers;
mod regime;
mod render;
mod scaling;
mod settings;
mod summary;
mod table;
mod tried;

use libration_study::Tried;

pub use self::settings::RolloutSettings;
use self::tried::TRIED;
use libration_report::Record;
use libration_report::page::Page;
use libration_report::record::RecordError;
use libration_study::{Lab, Section, Study, StudyError};

use crate::desk::Desk;

/// The study `rollout`.
#[derive(Clone, Copy, Debug)]
pub struct Rollout;

impl Study for Rollout {
    fn name(&self) -> &'static str {
        "rollout"
    }

    fn question(&self) -> &'static str {
        "How fast are rollouts of many environments, what limits them, and what do their bits depend on?"
    }

    fn tries(&self) -> &'static [Tried] {
        TRIED
    }

    fn settings(&self) -> Option<Section> {
        Some(Section::of::<RolloutSettings>())
    }

    fn run(&self, lab: &Lab<'_>) -> Result<Record, StudyError> {
        let desk = Desk::new(lab)?;
        let mut record = Record::new(self.name(), self.question());
        let parts: [(&str, Part); 7] = [
            ("layouts and ways to write", cases::measure),
            ("environments and horizons", scaling::measure),
            ("fresh memory", fresh::measure),
            ("advantages", advantages::measure),
            ("bits", kept::measure),
            ("layout", layout::measure),
            ("peers", peers::measure),
        ];
        for (what, part) in parts {
            lab.part(what, || part(&desk, &mut record))?;
        }
        table::check(&mut record);
        regime::detect(&mut record)?;
        summary::compare(lab, &mut record)?;
        claims::judge(&mut record);
        Ok(record)
    }

    fn render(&self, record: &Record, page: &mut Page) -> Result<(), RecordError> {
        render::render(record, page)
    }
}

/// A part of the study.
type Part = fn(&Desk<'_>, &mut Record) -> Result<(), StudyError>;
