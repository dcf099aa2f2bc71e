//! What accuracy costs: force evaluations and time against stability and errors.

mod answers;
mod claims;
mod cost;
mod demand;
mod render;
mod work;

use libration::State;

use crate::page::Page;
use crate::record::RecordError;
use crate::study::{Study, StudyError};
use crate::{Config, Lab, Record};

/// The study `efficiency`.
#[derive(Clone, Copy, Debug)]
pub struct Efficiency;

impl Study for Efficiency {
    fn name(&self) -> &'static str {
        "efficiency"
    }

    fn question(&self) -> &'static str {
        "Which integrator gives the accuracy I need for the least work?"
    }

    fn run(&self, lab: &Lab<'_>) -> Result<Record, StudyError> {
        let mut record = Record::new(self.name(), self.question());
        let costs = cost::measure(lab, &mut record)?;
        work::measure(lab, &costs, &mut record)?;
        answers::give(lab, &costs, &mut record)?;
        claims::judge(&mut record);
        Ok(record)
    }

    fn render(&self, record: &Record, page: &mut Page) -> Result<(), RecordError> {
        render::render(record, page)
    }
}

/// The start in units in which `ω = 1`.
fn start(config: &Config) -> State<f64, 1> {
    State { q: [config.start.q], v: [config.start.v / config.oscillator.omega()] }
}
