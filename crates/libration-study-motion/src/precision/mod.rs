//! What the float type costs: rounding of steps, orbits that close, clocks that lag.

mod claims;
mod clock;
mod crossover;
mod figures;
mod in_float;
mod kind;
mod methods;
mod orbits;
mod parts;
mod render;
mod settings;
mod textbook;
mod trial;
mod tried;
mod types;

use libration_study::Tried;

pub use self::settings::PrecisionSettings;
use self::tried::TRIED;
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

    fn tries(&self) -> &'static [Tried] {
        TRIED
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
        parts::measure(lab, &mut record)?;
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
