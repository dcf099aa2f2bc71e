//! The study `latency`: late forces and commands, in simulation and in theory.

mod claims;
mod critical_latency;
mod figures;
mod late_force;
mod latency_windows;
mod loop_simulation;
mod map;
mod mean_growth;
mod random_latency;
mod render;
mod single_precision;
mod source_claims;
mod stability_edge;

use libration_report::Record;
use libration_report::page::Page;
use libration_report::record::RecordError;
use libration_study::{Lab, SourceClaim, Study, StudyError};

use self::source_claims::SOURCE_CLAIMS;

/// The study `latency`. Its loops are its own, on the spring of the source; nothing of it is configured.
#[derive(Clone, Copy, Debug)]
pub struct Latency;

impl Study for Latency {
    fn name(&self) -> &'static str {
        "latency"
    }

    fn question(&self) -> &'static str {
        "How much latency does a control loop tolerate?"
    }

    fn source_claims(&self) -> &'static [SourceClaim] {
        SOURCE_CLAIMS
    }

    fn run(&self, lab: &Lab<'_>) -> Result<Record, StudyError> {
        let mut record = Record::new(self.name(), self.question());
        late_force::measure(lab, &mut record)?;
        single_precision::measure(lab, &mut record)?;
        critical_latency::measure(lab, &mut record)?;
        latency_windows::measure(lab, &mut record)?;
        map::measure(lab, &mut record)?;
        random_latency::measure(lab, &mut record)?;
        claims::judge(&mut record);
        Ok(record)
    }

    fn render(&self, record: &Record, page: &mut Page) -> Result<(), RecordError> {
        render::render(record, page)
    }
}
