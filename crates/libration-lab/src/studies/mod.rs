//! The studies, in the order in which they are told.

use crate::study::Study;

/// All studies.
pub const ALL: &[&dyn Study] = &[];

/// The study of that name, if there is one.
pub fn by_name(name: &str) -> Option<&'static dyn Study> {
    ALL.iter().copied().find(|study| study.name() == name)
}
