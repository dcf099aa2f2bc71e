//! A finding of an audit: what a user of the step should know or mend.

use serde::Serialize;

use crate::FindingKind;

/// A finding.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// Its kind, the same word for the same thing.
    pub kind: FindingKind,
    /// Whether it is a fault of the simulator; else a fact without which its numbers mislead.
    pub is_fault: bool,
    /// The finding in a sentence, with its evidence.
    pub text: String,
    /// What to change, in a sentence.
    pub help: String,
}

impl Finding {
    /// Without help, which requires the longest stable step.
    pub(crate) fn new(kind: FindingKind, is_fault: bool, text: String) -> Self {
        Finding { kind, is_fault, text, help: String::new() }
    }

    pub(crate) fn fault(kind: FindingKind, text: String) -> Self {
        Finding::new(kind, true, text)
    }

    pub(crate) fn warning(kind: FindingKind, text: String) -> Self {
        Finding::new(kind, false, text)
    }
}
