//! Settings in manifests.

use std::collections::BTreeMap;

use libration::equations::TaskDefinitions;
use libration::rl::task::{Regulate, Track};
use libration::rl::{EpisodeNumber, ProgramEnvironment};
use serde_json::{Map, Value, json};

use super::DataFormat;
use super::settings::Dataset;
use crate::environments::{
    CatalogueTask, EnvironmentSubject, EquationSubject, Noise, PolicySettings, Task,
};

/// Version of the manifest format.
const SCHEMA: &str = "libration.dataset/2";

/// The first line of the manifest for some groups: the settings, and `groups`.
pub(super) fn manifest_head(
    dataset: &Dataset,
    format: DataFormat,
    groups: [usize; 2],
) -> Map<String, Value> {
    let mut head = dataset.settings(format);
    head.insert("groups".to_owned(), json!(groups));
    head
}

impl Dataset {
    /// The settings in a manifest: the keys of the settings file, and those common to all files.
    pub(super) fn settings(&self, format: DataFormat) -> Map<String, Value> {
        // In the order of the tensor.
        let seen = self.environment.observed().into_iter();
        let seen: Vec<_> = seen.map(|(name, unit)| json!({ "name": name, "unit": unit })).collect();
        let value = json!({
            "schema": SCHEMA,
            "version": env!("CARGO_PKG_VERSION"),
            "format": format.name(),
            "observation": seen,
            "data": self.data(),
        });
        match value {
            Value::Object(map) => map,
            _ => Map::new(),
        }
    }

    /// The keys of the settings file.
    pub(super) fn data(&self) -> Value {
        let policy = match &self.policy {
            PolicySettings::Linear { weights, bias } => {
                json!({ "weights": weights, "bias": one_or_each(bias) })
            }
            PolicySettings::Random { low, high } => {
                json!({ "low": one_or_each(low), "high": one_or_each(high) })
            }
            PolicySettings::Constant(action) => json!({ "action": one_or_each(action) }),
        };
        let definition = &self.environment.definition;
        let ProgramEnvironment { method, dt, substeps, limit, delays, .. } = *definition;
        let Noise { jitter, skew, observation } = Noise::of(definition);
        let own = match &self.environment.subject {
            EnvironmentSubject::Catalogue(task) => catalogued(task, &definition.start),
            EnvironmentSubject::Equations(subject) => by_equations(subject, definition),
        };
        let mut data = json!({
            "seed": self.seed,
            "dtype": self.float.name(),
            "num_envs": self.environments,
            "steps": self.steps,
            "integrator": method.name(),
            "dt": dt,
            "substeps": substeps,
            "max_episode_steps": limit.unwrap_or(0),
            "chunk": { "num_envs": self.chunk.environments, "steps": self.chunk.steps },
        });
        for (key, value) in own {
            data[key] = value;
        }
        let seconds = |steps: [u32; 2]| steps.map(|steps| f64::from(steps) * dt);
        data["delays"] = json!({
            "observation": seconds(delays.observation), "action": seconds(delays.action),
        });
        let noise = json!({
            "jitter": jitter.rms(), "skew": skew.rms(), "observation": observation.rms(),
        });
        data["noise"] = noise;
        data["policy"] = json!({ self.policy.name(): policy });
        data
    }
}

/// A number for JSON, which has no infinite ones.
fn number(x: f64) -> Value {
    if x.is_finite() { json!(x) } else { json!(x.to_string()) }
}

/// The number of the only action, or a list.
fn one_or_each(numbers: &[f64]) -> Value {
    match numbers {
        [x] => number(*x),
        all => all.iter().map(|&x| number(x)).collect(),
    }
}

/// System, task and start of the catalogue.
fn catalogued(subject: &CatalogueTask, start: &[[f64; 2]]) -> Vec<(&'static str, Value)> {
    let CatalogueTask { actuation, task, .. } = subject;
    let system = subject.system();
    let parameters = actuation.parameters(system).into_iter();
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
    let numbers = match task {
        Task::Regulate(r) => regulate(r, json!({})),
        Task::SwingUp(s) => json!({ "velocity": s.velocity, "effort": s.effort }),
        Task::Track(Track { reference, regulate: r }) => {
            let reference = json!({
                "amplitude": reference.amplitude,
                "angular_frequency": reference.angular_frequency,
                "phase": reference.phase,
            });
            regulate(r, reference)
        }
    };
    vec![
        ("system", json!({ system.name(): parameters })),
        ("task", json!({ task.name(): numbers })),
        ("start", json!({ "q": start[0], "v": start[1] })),
    ]
}

/// System and task by equations: all of it, so that a manifest needs no other file.
fn by_equations(
    subject: &EquationSubject,
    definition: &ProgramEnvironment,
) -> Vec<(&'static str, Value)> {
    let EquationSubject { system, text, parameters, task } = subject;
    let parameters: Map<String, Value> =
        parameters.iter().map(|(name, value)| (name.clone(), number(*value))).collect();
    let start: Map<String, Value> = system
        .states
        .iter()
        .map(|state| (state.name.clone(), json!(task.start[state.place])))
        .collect();
    let TaskDefinitions { observe, reward, terminated, project, targets, inner } =
        &task.definitions;
    let saturation: Vec<f64> =
        definition.saturation.iter().filter_map(EpisodeNumber::as_constant).collect();
    let equations = json!({
        "text": text,
        "parameters": parameters,
        "max_action": one_or_each(&saturation),
    });
    let mut expressions = json!({
        "observe": observe, "reward": reward, "terminated": terminated, "start": start,
    });
    if !project.is_empty() {
        expressions["project"] = json!(project.iter().cloned().collect::<BTreeMap<_, _>>());
    }
    if !inner.is_empty() {
        expressions["targets"] = json!(targets);
        expressions["inner"] = json!(inner.iter().cloned().collect::<BTreeMap<_, _>>());
    }
    if let Some(period) = task.inner_period {
        expressions["inner_period"] = json!(period);
    }
    if !task.levels.is_empty() {
        expressions["actions"] = json!(task.levels);
    }
    vec![
        ("system", json!({ "equations": equations })),
        ("task", json!({ "expressions": expressions })),
    ]
}
