//! Settings of data sets.

use libration_analyze::trajectory::FloatType;
use libration_settings::{ConfigCommand, Document, SettingsError};

use super::system_tables::EquationSource;
use super::tables::File;
use crate::environments::{EnvironmentSettings, EnvironmentSubject, PolicySettings};

/// The default settings with comments, ready to edit: the case of the source report.
pub const DEFAULT: &str = include_str!("default.toml");

/// The settings of a data set: environments, policy and division into chunks.
#[derive(Clone, Debug, PartialEq)]
pub struct Dataset {
    pub(super) seed: u64,
    pub(super) float: FloatType,
    pub(super) environments: usize,
    pub(super) steps: u64,
    pub(super) chunk: Chunk,
    pub(super) environment: EnvironmentSettings,
    pub(super) policy: PolicySettings,
}

/// The size of the chunks that are computed and written at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Chunk {
    pub(super) environments: usize,
    pub(super) steps: usize,
}

/// Largest number of steps of an environment.
pub(super) const STEPS: u64 = 1_000_000_000_000;

/// Parses settings; missing keys have their defaults.
///
/// # Errors
/// The error with its position; `file_name` is the name in messages.
pub fn parse(text: &str, file_name: &str) -> Result<Dataset, SettingsError> {
    parse_changed(text, file_name, |_| {})
}

/// Parses settings with a system by equations in place of theirs, and other values of some of its parameters.
///
/// # Errors
/// As for [`parse`].
pub fn parse_of(
    system: EquationSource<'_>,
    parameters: &[(String, f64)],
    text: &str,
    file_name: &str,
) -> Result<Dataset, SettingsError> {
    parse_changed(text, file_name, |file| file.replace_system(system, parameters))
}

fn parse_changed(
    text: &str,
    file_name: &str,
    change: impl FnOnce(&mut File),
) -> Result<Dataset, SettingsError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let document = Document::parse(text, file_name)?;
    document.check_keys(ConfigCommand::ROLLOUT.keys)?;
    let mut file: File = toml::from_str(text).map_err(|error| document.explain(&error))?;
    change(&mut file);
    Dataset::try_from(file).map_err(|fault| document.locate(fault))
}

impl Default for Dataset {
    fn default() -> Self {
        // A test parses it.
        parse(DEFAULT, "default").unwrap_or_else(|error| unreachable!("{error}"))
    }
}

impl Dataset {
    /// The caveats about the integrator on the system, and about environments that are all the same.
    pub fn caveats(&self) -> Vec<String> {
        let is_fixed = !matches!(self.policy, PolicySettings::Random { .. });
        let is_named = matches!(self.environment.subject, EnvironmentSubject::Catalogue(_));
        let repeats = is_named && is_fixed && self.environment.draws_nothing();
        let same = (repeats && self.environments > 1).then(|| {
            format!(
                "all {} environments are the same, as nothing is drawn: give `start` an interval such as q = [-1.0, 1.0], or use noise or a random policy",
                self.environments
            )
        });
        self.environment.caveat().into_iter().chain(same).collect()
    }

    /// The same data set with `transitions` transitions, rounded up to whole steps of all environments.
    ///
    /// # Errors
    /// In words, if there are too many.
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

    /// The number of transitions.
    pub fn len(&self) -> u128 {
        self.environments as u128 * u128::from(self.steps)
    }

    /// The number of transitions of shard `index` of `of`.
    pub fn share(&self, [index, of]: [usize; 2]) -> u64 {
        let first = |index: usize| {
            (self.groups() * index / of.max(1) * self.chunk.environments).min(self.environments)
        };
        let environments = first(index) - first(index.saturating_sub(1));
        (environments as u64).saturating_mul(self.steps)
    }

    /// Whether it has no transitions, which does not occur.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The number of groups of environments.
    pub(super) fn groups(&self) -> usize {
        self.environments.div_ceil(self.chunk.environments)
    }

    /// The number of chunks per group.
    pub(super) fn chunks(&self) -> u64 {
        self.steps.div_ceil(self.chunk.steps as u64)
    }
}
