//! How late a command may be: forces and commands that come late, in simulation and in theory.

mod chance;
mod claims;
mod edge;
mod figures;
mod force;
mod map;
mod onset;
mod render;
mod simulated;
mod single;
mod tried;
mod window;

use libration_report::Record;
use libration_report::page::Page;
use libration_report::record::RecordError;
use libration_study::{Lab, Study, StudyError, Tried};

use self::tried::TRIED;

/// The study `latency`. Its loops are its own, on the spring of the source; nothing of it is configured.
#[derive(Clone, Copy, Debug)]
pub struct Latency;

impl Study for Latency {
    fn name(&self) -> &'static str {
        "latency"
    }

    fn question(&self) -> &'static str {
        "How late may a command be?"
    }

    fn tries(&self) -> &'static [Tried] {
        TRIED
    }

    fn run(&self, lab: &Lab<'_>) -> Result<Record, StudyError> {
        let mut record = Record::new(self.name(), self.question());
        force::measure(lab, &mut record)?;
        single::measure(lab, &mut record)?;
        onset::measure(lab, &mut record)?;
        window::measure(lab, &mut record)?;
        map::measure(lab, &mut record)?;
        chance::measure(lab, &mut record)?;
        claims::judge(&mut record);
        Ok(record)
    }

    fn render(&self, record: &Record, page: &mut Page) -> Result<(), RecordError> {
        render::render(record, page)
    }
}
