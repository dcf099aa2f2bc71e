//! The study `throughput`: rates of many trajectories and their limits.

mod bandwidth;
mod claims;
mod comparison;
mod faults;
mod figures;
mod fused;
mod latency;
mod machine;
mod one_step;
mod peers;
mod perturbed;
mod render;
mod roofline;
mod scaling;
mod scaling_limit;
mod settings;
mod sine;
mod source_claims;
mod threads;

use libration_study::SourceClaim;

pub use self::settings::ThroughputSettings;
use self::source_claims::SOURCE_CLAIMS;
use libration_report::Record;
use libration_report::page::Page;
use libration_report::record::RecordError;
use libration_study::{Lab, Section, Study, StudyError};

use crate::measurement::Measurement;

pub use scaling::{Rate, Wanted, ladder};

/// The study `throughput`.
#[derive(Clone, Copy, Debug)]
pub struct Throughput;

impl Study for Throughput {
    fn name(&self) -> &'static str {
        "throughput"
    }

    fn measures_the_machine(&self) -> bool {
        true
    }

    fn question(&self) -> &'static str {
        "How fast do many trajectories advance on this machine, and what limits them?"
    }

    fn source_claims(&self) -> &'static [SourceClaim] {
        SOURCE_CLAIMS
    }

    fn settings(&self) -> Option<Section> {
        Some(Section::of::<ThroughputSettings>())
    }

    fn run(&self, lab: &Lab<'_>) -> Result<Record, StudyError> {
        let measurement = Measurement::new(lab)?;
        let mut record = Record::new(self.name(), self.question());
        let parts: [(&str, Part); 11] = [
            ("fused steps against independent arithmetic", fused::measure),
            ("threads", threads::measure),
            ("a lone trajectory", latency::measure),
            ("sines", sine::measure),
            ("clocks and delays", perturbed::measure),
            ("memory", bandwidth::measure),
            ("one step a pass", one_step::measure),
            ("page faults", faults::measure),
            ("steps a pass", roofline::measure),
            ("implementations", scaling::measure),
            ("peers", peers::measure),
        ];
        for (what, part) in parts {
            lab.part(what, || part(&measurement, &mut record))?;
        }
        scaling_limit::detect(&mut record)?;
        comparison::compare(&mut record)?;
        claims::judge(&mut record);
        machine::describe(&measurement, &mut record)?;
        Ok(record)
    }

    fn render(&self, record: &Record, page: &mut Page) -> Result<(), RecordError> {
        render::render(record, page)
    }
}

/// A part of the study.
type Part = fn(&Measurement<'_>, &mut Record) -> Result<(), StudyError>;
