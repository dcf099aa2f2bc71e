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

    /// Names of what is seen, and whether each is a position, a velocity or neither.
    pub(super) fn seen(&self) -> &'static [(&'static str, Seen)] {
        use Seen::{Neither, Position, Velocity};
        const STATE: [(&str, Seen); 4] = [
            ("q0", Position),
            ("v0", Velocity),
            ("reference_q0", Position),
            ("reference_v0", Velocity),
        ];
        match self {
            Task::Regulate(_) => &STATE[..2],
            Task::SwingUp(_) => &[("cos_q0", Neither), ("sin_q0", Neither), ("v0", Velocity)],
            Task::Track(_) => &STATE,
        }
    }
}

/// What a number is that is seen.
#[derive(Clone, Copy)]
pub(super) enum Seen {
    Position,
    Velocity,
    Neither,
}

impl Dataset {
    /// Units of positions, velocities and actions, which are accelerations.
    pub(super) fn units(&self) -> [&'static str; 3] {
        // That of a swing-up is an angle, whatever the system.
        match (self.system, &self.task) {
            (AnySystem::Pendulum(_), _) | (_, Task::SwingUp(_)) => ["rad", "rad/s", "rad/s²"],
            _ => ["m", "m/s", "m/s²"],
        }
    }

    /// Names and units of what is seen.
    pub(super) fn seen(&self) -> Vec<(&'static str, &'static str)> {
        let [position, velocity, _] = self.units();
        let unit = |seen| match seen {
            Seen::Position => position,
            Seen::Velocity => velocity,
            Seen::Neither => "1",
        };
        self.task.seen().iter().map(|&(name, seen)| (name, unit(seen))).collect()
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

/// The most steps of an environment.
pub(super) const STEPS: u64 = 1_000_000_000_000;

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
