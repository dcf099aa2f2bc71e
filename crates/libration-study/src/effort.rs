//! The effort of a run.

use serde::{Deserialize, Serialize};

/// The effort of a run.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
)]
#[serde(rename_all = "kebab-case")]
pub enum Effort {
    /// A few seconds: coarse sweeps, the same findings.
    Quick,
    /// The effort of the published report.
    #[default]
    Standard,
    /// Finer sweeps and longer horizons.
    Thorough,
}

impl Effort {
    /// All efforts.
    pub const ALL: [Effort; 3] = [Effort::Quick, Effort::Standard, Effort::Thorough];

    /// Returns the name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Effort::Quick => "quick",
            Effort::Standard => "standard",
            Effort::Thorough => "thorough",
        }
    }

    /// Returns the effort with a name, if it exists.
    pub fn from_name(name: &str) -> Option<Effort> {
        Effort::ALL.into_iter().find(|effort| effort.name() == name)
    }

    /// Returns the value of this effort.
    pub fn choose<T>(self, quick: T, standard: T, thorough: T) -> T {
        match self {
            Effort::Quick => quick,
            Effort::Standard => standard,
            Effort::Thorough => thorough,
        }
    }
}
