//! When the torques of servos are computed.

use serde::{Deserialize, Serialize};

/// When the torques of servos are computed, if a time step has several substeps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Torque {
    /// Anew in each substep, by the integrator itself, as the servos of a simulator are.
    #[default]
    EachSubstep,
    /// Once in each time step, and held over its substeps, as those of a controller outside are.
    Held,
}

impl Torque {
    /// It in words, behind a number of substeps.
    pub(super) fn in_words(self) -> &'static str {
        match self {
            Torque::EachSubstep => "with torques computed anew in each substep",
            Torque::Held => "with torques computed once per step and held",
        }
    }
}
