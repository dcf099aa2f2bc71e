//! The study `memory`: size of rollouts and its growth.

mod capacity;
mod cases;
mod claims;
mod figures;
mod growth;
mod render;
mod source_claims;
mod types;

use libration::rl::Plan;
use libration_report::Record;
use libration_report::page::Page;
use libration_report::record::RecordError;
use libration_study::{Lab, SourceClaim, Study, StudyError};

use self::source_claims::SOURCE_CLAIMS;

/// Numbers that are seen in a transition of the source's oscillator: position and velocity.
const OBSERVATION: usize = 2;

/// Numbers that are done.
const ACTION: usize = 1;

/// Bytes of a transition by theory: observation, action and reward in `f32`, and a flag.
const BYTES: usize = (OBSERVATION + ACTION + 1) * 4 + 1;

/// A megabyte, and what the source calls so.
const MB: f64 = 1e6;
const MIB: f64 = (1 << 20) as f64;

/// All bytes that a plan provides for in `f32`.
fn bytes(plan: Plan) -> f64 {
    plan.bytes(OBSERVATION, ACTION, size_of::<f32>()) as f64
}

/// The study `memory`.
#[derive(Clone, Copy, Debug)]
pub struct Memory;

impl Study for Memory {
    fn name(&self) -> &'static str {
        "memory"
    }

    fn measures_the_machine(&self) -> bool {
        true
    }

    fn question(&self) -> &'static str {
        "How much memory do rollouts take, how does it grow, and when is it full?"
    }

    fn source_claims(&self) -> &'static [SourceClaim] {
        SOURCE_CLAIMS
    }

    fn run(&self, lab: &Lab<'_>) -> Result<Record, StudyError> {
        let mut record = Record::new(self.name(), self.question());
        cases::measure(&mut record)?;
        types::measure(&mut record);
        growth::measure(&mut record)?;
        lab.part("a rate", || capacity::measure(lab, &mut record))?;
        claims::judge(&mut record);
        Ok(record)
    }

    fn render(&self, record: &Record, page: &mut Page) -> Result<(), RecordError> {
        render::render(record, page)
    }
}
