//! The studies, in the order in which they are told.

mod coverage;
mod drift;
mod efficiency;
mod error;
mod growth;
mod ink;
mod rounding;
mod spectrum;
mod stability;

use crate::study::Study;
pub use drift::Drift;
pub use efficiency::Efficiency;
pub use error::Error;
pub use spectrum::Spectrum;
pub use stability::Stability;

/// All studies.
pub const ALL: &[&dyn Study] = &[&Spectrum, &Drift, &Error, &Stability, &Efficiency];

/// The study of that name, if there is one.
pub fn by_name(name: &str) -> Option<&'static dyn Study> {
    ALL.iter().copied().find(|study| study.name() == name)
}
