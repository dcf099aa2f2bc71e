//! What a data set is made of.

use libration::analysis::Jitter;
use libration::rl::Delays;
use libration::rl::task::{Regulate, Sine, SwingUp, Track};
use libration::{AnySystem, Method};
use serde_json::{Map, Value, json};

use super::DataFormat;
use super::tables::{File, PolicyTable, TaskTable};
use crate::config::limits::{TIME_STEP, within};
use crate::config::{ConfigError, Count, Document, Fault, Number, names};
use crate::trajectory::FloatType;

/// The default settings with comments, ready to edit: the case of the source report.
pub const DEFAULT: &str = include_str!("default.toml");

/// Version of the contract that manifests keep.
const SCHEMA: &str = "libration.dataset/1";

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

impl Task {
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

/// `count`, if it is one of these.
fn count(
    key: &'static str,
    Count(count): Count,
    allowed: std::ops::RangeInclusive<u64>,
) -> Result<u64, Fault> {
    let found = u64::try_from(count).ok().filter(|count| allowed.contains(count));
    found.ok_or_else(|| {
        let (first, last) = (allowed.start(), allowed.end());
        Fault::new(key, format!("`{key}` is {count}, but it must be {first} to {last}"))
    })
}

/// `number`, if it is finite.
fn finite(key: &'static str, Number(number): Number) -> Result<f64, Fault> {
    if number.is_finite() {
        return Ok(number);
    }
    Err(Fault::new(key, format!("`{key}` is {number:?}, but it must be finite")))
}

/// `number`, if it is finite and not below zero.
fn least_zero(key: &'static str, Number(number): Number) -> Result<f64, Fault> {
    if number >= 0.0 && number.is_finite() {
        return Ok(number);
    }
    Err(Fault::new(key, format!("`{key}` is {number:?}, but it must be finite and at least 0")))
}

impl TryFrom<File> for Dataset {
    type Error = Fault;

    fn try_from(file: File) -> Result<Self, Fault> {
        let float = [FloatType::F32, FloatType::F64].into_iter().find(|f| f.name() == file.float);
        let float = float.ok_or_else(|| {
            let message = format!("`float` is `{}`, but it must be `f32` or `f64`", file.float);
            Fault::new("float", message)
        })?;
        let name = &file.integrator;
        let method = Method::from_name(name).ok_or_else(|| {
            let fault = Fault::new("integrator", format!("unknown integrator `{name}`"));
            fault.help(names::suggest("integrators", name, Method::ALL.map(Method::name)))
        })?;
        let dt = within(TIME_STEP, "dt", file.dt.0).map_err(|why| Fault::new("dt", why))?;
        let limit = count("limit", file.limit, 0..=u32::MAX.into())? as u32;
        let [observation, action] = [
            ("delays.observation", file.delays.observation),
            ("delays.action", file.delays.action),
        ]
        .map(|(key, ends)| -> Result<[u32; 2], Fault> {
            let [least, most] = ends.map(|end| count(key, end, 0..=4096));
            let (least, most) = (least? as u32, most? as u32);
            if least > most {
                let message = format!("`{key}` is from {least} to {most}, but it must rise");
                return Err(Fault::new(key, message));
            }
            Ok([least, most])
        });
        let ends = |key, ends: [Number; 2]| -> Result<[f64; 2], Fault> {
            let [low, high] = ends.map(|end| finite(key, end));
            let (low, high) = (low?, high?);
            if low > high {
                let message = format!("`{key}` is from {low:?} to {high:?}, but it must rise");
                return Err(Fault::new(key, message));
            }
            Ok([low, high])
        };
        let task = task(file.task)?;
        Ok(Dataset {
            seed: count("seed", file.seed, 0..=u64::MAX)?,
            float,
            environments: count("environments", file.environments, 1..=1_000_000_000)? as usize,
            steps: count("steps", file.steps, 1..=1_000_000_000_000)?,
            method,
            dt,
            substeps: count("substeps", file.substeps, 1..=1_000_000)? as u32,
            limit: Some(limit).filter(|&limit| limit > 0),
            chunk: Chunk {
                environments: count("chunk.environments", file.chunk.environments, 1..=1_000_000)?
                    as usize,
                steps: count("chunk.steps", file.chunk.steps, 1..=1_000_000)? as usize,
            },
            system: system(&file)?,
            task,
            start: [ends("start.q", file.start.q)?, ends("start.v", file.start.v)?],
            delays: Delays { observation: observation?, action: action? },
            noise: Noise {
                jitter: least_zero("noise.jitter", file.noise.jitter)?,
                skew: least_zero("noise.skew", file.noise.skew)?,
                observation: least_zero("noise.observation", file.noise.observation)?,
            },
            policy: policy(file.policy, task.seen().len())?,
        })
    }
}

fn system(file: &File) -> Result<AnySystem, Fault> {
    let mut systems = file.system.iter();
    let (Some((name, parameters)), None) = (systems.next(), systems.next()) else {
        return Err(Fault::new("system", "`system` must be one table, as [system.oscillator]"));
    };
    let parameters: Vec<_> = parameters.iter().map(|(name, value)| (name, value.0)).collect();
    let system = AnySystem::build(name, &parameters);
    let system = system.map_err(|error| Fault::new("system", error.to_string()))?;
    if !system.entry().dimensions.contains(&1) {
        let message = format!("`{name}` has no single degree of freedom, as a data set needs");
        return Err(Fault::new("system", message));
    }
    Ok(system)
}

fn task(table: TaskTable) -> Result<Task, Fault> {
    let regulate = |[position, velocity, effort, bound]: [Number; 4]| -> Result<Regulate, Fault> {
        if bound.0.is_nan() || bound.0 <= 0.0 {
            let message = format!("`bound` is {:?}, but it must be greater than 0", bound.0);
            return Err(Fault::new("task", message));
        }
        let prices = [position, velocity, effort].map(|price| finite("task", price));
        let [position, velocity, effort] = prices;
        Ok(Regulate { position: position?, velocity: velocity?, effort: effort?, bound: bound.0 })
    };
    Ok(match table {
        TaskTable::Regulate(t) => {
            Task::Regulate(regulate([t.position, t.velocity, t.effort, t.bound])?)
        }
        TaskTable::SwingUp(t) => Task::SwingUp(SwingUp {
            velocity: finite("task", t.velocity)?,
            effort: finite("task", t.effort)?,
        }),
        TaskTable::Track(t) => Task::Track(Track {
            reference: Sine {
                amplitude: finite("task", t.amplitude)?,
                angular_frequency: finite("task", t.angular_frequency)?,
                phase: finite("task", t.phase)?,
            },
            regulate: regulate([t.position, t.velocity, t.effort, t.bound])?,
        }),
    })
}

fn policy(table: PolicyTable, seen: usize) -> Result<Acting, Fault> {
    let key = "policy";
    Ok(match table {
        PolicyTable::Linear(t) => {
            if t.weights.len() != seen {
                let found = t.weights.len();
                let message = format!(
                    "`weights` are {found}, but they must be {seen}: one for each number that is seen"
                );
                return Err(Fault::new("policy.linear.weights", message));
            }
            let weights = t.weights.into_iter().map(|weight| finite(key, weight));
            Acting::Linear {
                weights: weights.collect::<Result<_, _>>()?,
                bias: finite(key, t.bias)?,
            }
        }
        PolicyTable::Random(t) => {
            let (low, high) = (finite(key, t.low)?, finite(key, t.high)?);
            if low >= high {
                let message = format!("actions are from {low:?} to {high:?}, but that must rise");
                return Err(Fault::new(key, message));
            }
            Acting::Random { low, high }
        }
        PolicyTable::Constant(t) => Acting::Constant(finite(key, t.action)?),
    })
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

    /// What manifests say: the keys of the file of settings, and what belongs to all files.
    pub(super) fn settings(&self, format: DataFormat) -> Map<String, Value> {
        let units: Map<String, Value> =
            self.task.seen().iter().map(|&(name, unit)| (name.to_owned(), unit.into())).collect();
        let value = json!({
            "schema": SCHEMA,
            "version": env!("CARGO_PKG_VERSION"),
            "format": format.name(),
            "observation": units,
            "data": self.data(),
        });
        match value {
            Value::Object(map) => map,
            _ => Map::new(),
        }
    }

    /// As the file of settings has it.
    fn data(&self) -> Value {
        // JSON has no infinite numbers.
        let number = |x: f64| if x.is_finite() { json!(x) } else { json!(x.to_string()) };
        let parameters = self.system.parameters().into_iter();
        let parameters: Map<String, Value> =
            parameters.map(|(name, value)| (name.to_owned(), number(value))).collect();
        let regulate = |r: &Regulate, mut more: Value| {
            for (name, value) in [
                ("position", r.position),
                ("velocity", r.velocity),
                ("effort", r.effort),
                ("bound", r.bound),
            ] {
                more[name] = number(value);
            }
            more
        };
        let task = match &self.task {
            Task::Regulate(r) => json!({ "regulate": regulate(r, json!({})) }),
            Task::SwingUp(s) => {
                json!({ "swing-up": { "velocity": s.velocity, "effort": s.effort } })
            }
            Task::Track(Track { reference, regulate: r }) => {
                let reference = json!({
                    "amplitude": reference.amplitude,
                    "angular_frequency": reference.angular_frequency,
                    "phase": reference.phase,
                });
                json!({ "track": regulate(r, reference) })
            }
        };
        let policy = match &self.policy {
            Acting::Linear { weights, bias } => {
                json!({ "linear": { "weights": weights, "bias": bias } })
            }
            Acting::Random { low, high } => json!({ "random": { "low": low, "high": high } }),
            Acting::Constant(action) => json!({ "constant": { "action": action } }),
        };
        let Noise { jitter, skew, observation } = self.noise;
        json!({
            "seed": self.seed,
            "float": self.float.name(),
            "environments": self.environments,
            "steps": self.steps,
            "integrator": self.method.name(),
            "dt": self.dt,
            "substeps": self.substeps,
            "limit": self.limit.unwrap_or(0),
            "chunk": { "environments": self.chunk.environments, "steps": self.chunk.steps },
            "system": { self.system.name(): parameters },
            "task": task,
            "start": { "q": self.start[0], "v": self.start[1] },
            "delays": { "observation": self.delays.observation, "action": self.delays.action },
            "noise": { "jitter": jitter, "skew": skew, "observation": observation },
            "policy": policy,
        })
    }
}
