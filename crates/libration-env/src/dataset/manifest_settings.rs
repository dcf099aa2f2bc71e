//! Settings in manifests.

use libration::rl::task::{Regulate, Track};
use serde_json::{Map, Value, json};

use super::DataFormat;
use super::settings::Dataset;
use crate::environments::{EnvironmentSettings, Noise, PolicySettings, Task};

/// Version of the manifest format.
const SCHEMA: &str = "libration.dataset/1";

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
    fn data(&self) -> Value {
        // JSON has no infinite numbers.
        let number = |x: f64| if x.is_finite() { json!(x) } else { json!(x.to_string()) };
        let EnvironmentSettings {
            system, actuation, method, dt, substeps, task, start, limit, ..
        } = &self.environment;
        let EnvironmentSettings { delays, noise, .. } = &self.environment;
        let system = system.any();
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
        let policy = match &self.policy {
            PolicySettings::Linear { weights, bias } => json!({ "weights": weights, "bias": bias }),
            PolicySettings::Random { low, high } => json!({ "low": low, "high": high }),
            PolicySettings::Constant(action) => json!({ "action": action }),
        };
        let Noise { jitter, skew, observation } = noise;
        json!({
            "seed": self.seed,
            "float": self.float.name(),
            "environments": self.environments,
            "steps": self.steps,
            "integrator": method.name(),
            "dt": dt,
            "substeps": substeps,
            "limit": limit.unwrap_or(0),
            "chunk": { "environments": self.chunk.environments, "steps": self.chunk.steps },
            "system": { system.name(): parameters },
            "task": { task.name(): numbers },
            "start": { "q": start[0], "v": start[1] },
            "delays": { "observation": delays.observation, "action": delays.action },
            "noise": { "jitter": jitter.rms(), "skew": skew.rms(), "observation": observation.rms() },
            "policy": { self.policy.name(): policy },
        })
    }
}
