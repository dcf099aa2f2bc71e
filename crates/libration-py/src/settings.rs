//! Settings of environments from Python.

use libration::ensemble::Execution;
use libration::rl::task::{Regulate, Sine, SwingUp, Track};
use libration::rl::{Autoreset, Delays};
use libration_env::environments::{EnvironmentSettings, Noise, SingleDofSystem, Task};
use pyo3::prelude::*;

use crate::error::{Raised, unknown, value_error};
use crate::request::{SystemRequest, law, method, system};

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
    system: SystemRequest,
    task: (String, Vec<f64>),
    start: [[f64; 2]; 2],
    observation_delay: [u32; 2],
    action_delay: [u32; 2],
    jitter: (String, f64),
    skew: (String, f64),
    noise: (String, f64),
}

impl Settings {
    /// Whether the float type is `f32`.
    pub(crate) fn single(&self) -> PyResult<bool> {
        match self.dtype.as_str() {
            "float32" => Ok(true),
            "float64" => Ok(false),
            other => Err(unknown("dtype", other, ["float32", "float64"])),
        }
    }

    pub(crate) fn autoreset(&self) -> PyResult<Autoreset> {
        match self.autoreset.as_str() {
            "NextStep" => Ok(Autoreset::NextStep),
            "SameStep" => Ok(Autoreset::SameStep),
            "Disabled" => Ok(Autoreset::Disabled),
            other => Err(unknown("autoreset mode", other, ["NextStep", "SameStep", "Disabled"])),
        }
    }

    pub(crate) fn execution(&self) -> PyResult<Execution> {
        let execution = Execution::serial().threads(self.threads);
        execution.map_err(|error| libration::rl::EnvironmentError::from(error).raised())
    }

    pub(crate) fn environments(&self) -> PyResult<EnvironmentSettings> {
        let method = method(&self.integrator)?;
        let (system, actuation) = system(&self.system)?;
        let system = SingleDofSystem::new(system).ok_or_else(|| {
            let name = &self.system.0;
            value_error(format!("system is {name}, but it must have a single degree of freedom"))
        })?;
        Ok(EnvironmentSettings {
            system,
            actuation,
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
                jitter: law("jitter", &self.jitter.0, self.jitter.1)?,
                skew: law("skew", &self.skew.0, self.skew.1)?,
                observation: law("observation_noise", &self.noise.0, self.noise.1)?,
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
            _ => return Err(unknown("task", name, ["regulate", "swing-up", "track"])),
        })
    }
}
