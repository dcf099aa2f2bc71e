//! The study `precision`: rounding of steps, closed orbits, slow clocks.

mod claims;
mod clock;
mod crossover;
mod figures;
mod float_type;
mod in_float;
mod methods;
mod mixed_precision;
mod orbits;
mod render;
mod settings;
mod source_claims;
mod system;
mod textbook;
mod types;
mod verlet_run;

use libration_study::SourceClaim;

pub use self::settings::PrecisionSettings;
use self::source_claims::SOURCE_CLAIMS;
pub use self::system::SystemPrecision;
use libration_report::Record;
use libration_report::page::Page;
use libration_report::record::RecordError;
use libration_study::{Lab, Section, Study, StudyError};

/// The study `precision`.
#[derive(Clone, Copy, Debug)]
pub struct Precision;

impl Study for Precision {
    fn name(&self) -> &'static str {
        "precision"
    }

    fn question(&self) -> &'static str {
        "What does the float type cost?"
    }

    fn source_claims(&self) -> &'static [SourceClaim] {
        SOURCE_CLAIMS
    }

    fn settings(&self) -> Option<Section> {
        Some(Section::of::<PrecisionSettings>())
    }

    fn run(&self, lab: &Lab<'_>) -> Result<Record, StudyError> {
        let mut record = Record::new(self.name(), self.question());
        types::measure(lab, &mut record)?;
        textbook::measure(lab, &mut record)?;
        crossover::measure(lab, &mut record)?;
        clock::measure(lab, &mut record)?;
        mixed_precision::measure(lab, &mut record)?;
        methods::measure(lab, &mut record)?;
        claims::judge(lab.config, &mut record);
        Ok(record)
    }

    fn render(&self, record: &Record, page: &mut Page) -> Result<(), RecordError> {
        render::render(record, page)
    }
}

/// A time step in identifiers, as in `dt-0.001` or `dt-1e-300`.
fn tag(dt: f64) -> String {
    let plain = format!("dt-{dt}");
    if plain.len() > 24 { format!("dt-{dt:e}") } else { plain }
}
