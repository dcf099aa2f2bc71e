//! The study `efficiency`: force evaluations and time against stability and errors.

mod accuracy_target;
mod actions;
mod claims;
mod cost;
mod recommendations;
mod render;
mod settings;
mod source_claims;
mod work_precision;

use libration_study::SourceClaim;

pub use self::settings::EfficiencySettings;
use self::source_claims::SOURCE_CLAIMS;
use libration::{Method, State};
use libration_report::Record;
use libration_report::page::Page;
use libration_report::record::RecordError;
use libration_study::{Config, Lab, Section, Study, StudyError};

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

    fn source_claims(&self) -> &'static [SourceClaim] {
        SOURCE_CLAIMS
    }

    fn settings(&self) -> Option<Section> {
        Some(Section::of::<EfficiencySettings>())
    }

    fn run(&self, lab: &Lab<'_>) -> Result<Record, StudyError> {
        let mut record = Record::new(self.name(), self.question());
        let costs = cost::measure(lab, &mut record)?;
        work_precision::measure(lab, &costs, &mut record)?;
        recommendations::recommend(lab, &costs, &mut record)?;
        claims::judge(&mut record);
        Ok(record)
    }

    fn render(&self, record: &Record, page: &mut Page) -> Result<(), RecordError> {
        render::render(record, page)
    }
}

/// The integrators, then the splitting methods.
fn methods(config: &Config) -> Vec<Method> {
    let more = config.get::<EfficiencySettings>().splitting_methods;
    config.integrators.iter().copied().chain(more).collect()
}

/// The start in units in which `ω = 1`.
fn start(config: &Config) -> State<f64, 1> {
    State { q: [config.start.q], v: [config.start.v / config.oscillator.omega()] }
}
