//! The studies, in the order in which they are told.

mod ink;
mod spectrum;

use crate::study::Study;
pub use spectrum::Spectrum;

/// All studies.
pub const ALL: &[&dyn Study] = &[&Spectrum];

/// The study of that name, if there is one.
pub fn by_name(name: &str) -> Option<&'static dyn Study> {
    ALL.iter().copied().find(|study| study.name() == name)
}
