//! What environments are to be, as `libration` hands it over.

use libration::analysis::Jitter;
use libration::ensemble::Execution;
use libration::rl::task::{Regulate, Sine, SwingUp, Track};
use libration::rl::{Autoreset, Delays};
use libration::{AnySystem, Method};
use libration_lab::config::names;
use libration_lab::environments::{Lone, Noise, Recipe, Task};
use pyo3::prelude::*;

use crate::error::{Raised, refused};

/// All keys of the dictionary that Python makes of what it was given, in units of the engine.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Settings {
    pub(crate) num_envs: usize,
    dtype: String,
    threads: usize,
    autoreset: String,
    integrator: String,
    dt: f64,
    substeps: u32,
    limit: Option<u32>,
    saturation: f64,
    system: (String, Vec<(String, f64)>),
    task: (String, Vec<f64>),
    start: [[f64; 2]; 2],
    observation_delay: [u32; 2],
    action_delay: [u32; 2],
    jitter: (String, f64),
    skew: (String, f64),
    noise: (String, f64),
}

impl Settings {
    /// Whether numbers are short.
    pub(crate) fn single(&self) -> PyResult<bool> {
        match self.dtype.as_str() {
            "float32" => Ok(true),
            "float64" => Ok(false),
            other => Err(unknown("dtype", other, &["float32", "float64"])),
        }
    }

    pub(crate) fn autoreset(&self) -> PyResult<Autoreset> {
        match self.autoreset.as_str() {
            "NextStep" => Ok(Autoreset::NextStep),
            "SameStep" => Ok(Autoreset::SameStep),
            "Disabled" => Ok(Autoreset::Disabled),
            other => Err(unknown("autoreset mode", other, &["NextStep", "SameStep", "Disabled"])),
        }
    }

    pub(crate) fn execution(&self) -> PyResult<Execution> {
        let execution = Execution::serial().threads(self.threads);
        execution.map_err(|error| libration::rl::EnvironmentError::from(error).raised())
    }

    pub(crate) fn recipe(&self) -> PyResult<Recipe> {
        let method = Method::from_name(&self.integrator);
        let method = method.ok_or_else(|| {
            unknown("integrator", &self.integrator, &Method::ALL.map(Method::name))
        })?;
        let (name, parameters) = &self.system;
        let parameters: Vec<_> = parameters.iter().map(|(name, value)| (name, *value)).collect();
        let system = AnySystem::build(name, &parameters);
        let system = system.map_err(|error| refused(error.to_string()))?;
        let system = Lone::new(system).ok_or_else(|| {
            refused(format!("system is {name}, but it must have a single degree of freedom"))
        })?;
        Ok(Recipe {
            system,
            method,
            dt: self.dt,
            substeps: self.substeps,
            task: self.task()?,
            start: self.start,
            limit: self.limit,
            autoreset: self.autoreset()?,
            delays: Delays { observation: self.observation_delay, action: self.action_delay },
            saturation: self.saturation,
            noise: Noise {
                jitter: law("jitter", &self.jitter)?,
                skew: law("skew", &self.skew)?,
                observation: law("observation_noise", &self.noise)?,
            },
        })
    }

    fn task(&self) -> PyResult<Task> {
        let (name, numbers) = &self.task;
        Ok(match (name.as_str(), numbers.as_slice()) {
            ("regulate", &[position, velocity, effort, bound]) => {
                Task::Regulate(Regulate { position, velocity, effort, bound })
            }
            ("swing-up", &[velocity, effort]) => Task::SwingUp(SwingUp { velocity, effort }),
            (
                "track",
                &[amplitude, angular_frequency, phase, position, velocity, effort, bound],
            ) => Task::Track(Track {
                reference: Sine { amplitude, angular_frequency, phase },
                regulate: Regulate { position, velocity, effort, bound },
            }),
            _ => return Err(unknown("task", name, &["regulate", "swing-up", "track"])),
        })
    }
}

/// A law with mean zero.
fn law(name: &str, (law, rms): &(String, f64)) -> PyResult<Jitter> {
    if !(*rms >= 0.0 && rms.is_finite()) {
        return Err(refused(format!("{name} is {rms}, but it must be finite and at least 0")));
    }
    match law.as_str() {
        "gaussian" => Ok(Jitter::Gaussian(*rms)),
        "uniform" => Ok(Jitter::Uniform(*rms)),
        other => Err(unknown(&format!("law of {name}"), other, &["gaussian", "uniform"])),
    }
}

/// What is said of a name that is none of these.
fn unknown(what: &str, name: &str, known: &[&str]) -> PyErr {
    refused(format!(
        "unknown {what} `{name}`: {}",
        names::suggest(&format!("{what}s"), name, known.iter().copied())
    ))
}
