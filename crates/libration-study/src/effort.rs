//! How much work a run may take.

use serde::{Deserialize, Serialize};

/// How much work a run may take.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
)]
#[serde(rename_all = "kebab-case")]
pub enum Effort {
    /// A few seconds: coarse sweeps, the same findings.
    Quick,
    /// The report as it is meant to be.
    #[default]
    Standard,
    /// Finer sweeps and longer horizons.
    Thorough,
}

impl Effort {
    /// All of them.
    pub const ALL: [Effort; 3] = [Effort::Quick, Effort::Standard, Effort::Thorough];

    /// Name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Effort::Quick => "quick",
            Effort::Standard => "standard",
            Effort::Thorough => "thorough",
        }
    }

    /// The effort of that name, if there is one.
    pub fn from_name(name: &str) -> Option<Effort> {
        Effort::ALL.into_iter().find(|effort| effort.name() == name)
    }

    /// The one of three values that belongs to this effort.
    pub fn choose<T>(self, quick: T, standard: T, thorough: T) -> T {
        match self {
            Effort::Quick => quick,
            Effort::Standard => standard,
            Effort::Thorough => thorough,
        }
    }
}
