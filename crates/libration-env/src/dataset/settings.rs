//! What a data set is made of.

use libration_analyze::trajectory::FloatType;
use libration_settings::{Document, SettingsError};

use super::tables::File;
use crate::environments::{Acting, Recipe};

/// The default settings with comments, ready to edit: the case of the source report.
pub const DEFAULT: &str = include_str!("default.toml");

/// What a data set is made of: environments, what they do, and how it is divided.
#[derive(Clone, Debug, PartialEq)]
pub struct Dataset {
    pub(super) seed: u64,
    pub(super) float: FloatType,
    pub(super) environments: usize,
    pub(super) steps: u64,
    pub(super) chunk: Chunk,
    pub(super) recipe: Recipe,
    pub(super) policy: Acting,
}

/// The most of a data set that is computed, written and kept at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Chunk {
    pub(super) environments: usize,
    pub(super) steps: usize,
}

/// The most steps of an environment.
pub(super) const STEPS: u64 = 1_000_000_000_000;

/// Reads settings; keys that are not given take their defaults.
///
/// # Errors
/// What is wrong with `text`, and where; `file_name` is only shown.
pub fn parse(text: &str, file_name: &str) -> Result<Dataset, SettingsError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let document = Document::parse(text, file_name)?;
    let file: File = toml::from_str(text).map_err(|error| document.explain(&error))?;
    Dataset::try_from(file).map_err(|fault| document.locate(fault))
}

impl Default for Dataset {
    fn default() -> Self {
        // A test says that it can be read.
        parse(DEFAULT, "default").unwrap_or_else(|error| unreachable!("{error}"))
    }
}

impl Dataset {
    /// What must be known of its integrator on its system, if anything.
    pub fn caveat(&self) -> Option<String> {
        self.recipe.system.any().caveat(self.recipe.method)
    }

    /// The same with so many transitions, rounded up to whole steps of all environments.
    ///
    /// # Errors
    /// In words, if these are too many.
    pub fn transitions(self, transitions: u64) -> Result<Self, String> {
        let steps = transitions.div_ceil(self.environments as u64).max(1);
        if steps > STEPS {
            let n = self.environments;
            return Err(format!(
                "{n} environments would take {steps} steps; at most {STEPS} are allowed"
            ));
        }
        Ok(Dataset { steps, ..self })
    }

    /// How many transitions it has.
    pub fn len(&self) -> u128 {
        self.environments as u128 * u128::from(self.steps)
    }

    /// How many of them a shard has: the I-th of N.
    pub fn share(&self, [index, of]: [usize; 2]) -> u64 {
        let first = |index: usize| {
            (self.groups() * index / of.max(1) * self.chunk.environments).min(self.environments)
        };
        (first(index) - first(index.saturating_sub(1))) as u64 * self.steps
    }

    /// Whether it has none, which cannot be.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Groups of environments that are stepped together.
    pub(super) fn groups(&self) -> usize {
        self.environments.div_ceil(self.chunk.environments)
    }

    /// Chunks of each group.
    pub(super) fn chunks(&self) -> u64 {
        self.steps.div_ceil(self.chunk.steps as u64)
    }
}
