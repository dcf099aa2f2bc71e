//! What a data set is made of.

use libration::analysis::Jitter;
use libration::rl::Delays;
use libration::rl::task::{Regulate, Sine, SwingUp, Track};
use libration::{AnySystem, Method};

use super::tables::File;
use crate::config::{ConfigError, Document};
use crate::trajectory::FloatType;

/// The default settings with comments, ready to edit: the case of the source report.
pub const DEFAULT: &str = include_str!("default.toml");

/// What a data set is made of: environments, what they do, and how it is divided.
#[derive(Clone, Debug, PartialEq)]
pub struct Dataset {
    pub(super) seed: u64,
    pub(super) float: FloatType,
    pub(super) environments: usize,
    pub(super) steps: u64,
    pub(super) method: Method,
    pub(super) dt: f64,
    pub(super) substeps: u32,
    pub(super) limit: Option<u32>,
    pub(super) chunk: Chunk,
    pub(super) system: AnySystem,
    pub(super) task: Task,
    pub(super) start: [[f64; 2]; 2],
    pub(super) delays: Delays,
    pub(super) noise: Noise,
    pub(super) policy: Acting,
}

/// The most of a data set that is computed, written and kept at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Chunk {
    pub(super) environments: usize,
    pub(super) steps: usize,
}

/// Root mean squares, all of Gaussian laws.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Noise {
    pub(super) jitter: f64,
    pub(super) skew: f64,
    pub(super) observation: f64,
}

/// What is seen, paid, and over.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Task {
    Regulate(Regulate),
    SwingUp(SwingUp),
    Track(Track<Sine>),
}

/// Who acts.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Acting {
    Linear { weights: Vec<f64>, bias: f64 },
    Random { low: f64, high: f64 },
    Constant(f64),
}

impl Acting {
    /// Its name in the file of settings.
    pub(super) fn name(&self) -> &'static str {
        match self {
            Acting::Linear { .. } => "linear",
            Acting::Random { .. } => "random",
            Acting::Constant(_) => "constant",
        }
    }
}

impl Task {
    /// Its name in the file of settings.
    pub(super) fn name(&self) -> &'static str {
        match self {
            Task::Regulate(_) => "regulate",
            Task::SwingUp(_) => "swing-up",
            Task::Track(_) => "track",
        }
    }

    /// Names and units of what is seen.
    pub(super) fn seen(&self) -> &'static [(&'static str, &'static str)] {
        const STATE: [(&str, &str); 4] =
            [("q0", "m"), ("v0", "m/s"), ("reference_q0", "m"), ("reference_v0", "m/s")];
        match self {
            Task::Regulate(_) => &STATE[..2],
            Task::SwingUp(_) => &[("cos_q0", "1"), ("sin_q0", "1"), ("v0", "rad/s")],
            Task::Track(_) => &STATE,
        }
    }
}

impl Noise {
    /// Whether there is none.
    pub(super) fn is_none(&self) -> bool {
        self.jitter == 0.0 && self.skew == 0.0 && self.observation == 0.0
    }

    pub(super) fn skewed(&self) -> Jitter {
        Jitter::Gaussian(self.skew)
    }
}

/// Reads settings; keys that are not given take their defaults.
///
/// # Errors
/// What is wrong with `text`, and where; `file_name` is only shown.
pub fn parse(text: &str, file_name: &str) -> Result<Dataset, ConfigError> {
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
    /// The same with so many transitions, rounded up to whole steps of all environments.
    pub fn transitions(self, transitions: u64) -> Self {
        Dataset { steps: transitions.div_ceil(self.environments as u64).max(1), ..self }
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
