//! Settings of environments from Python.

use libration::control::Jitter;
use libration::ensemble::Execution;
use libration::rl::task::{Regulate, Sine, SwingUp, Track};
use libration::rl::{
    AnswerTimes, Autoreset, Delays, Distribution, EpisodeNumber, ErrorScale, ProgramEnvironment,
};
use libration_env::environments::{
    CatalogueTask, EnvironmentSettings, EnvironmentSubject, EquationSubject, Task,
};
use pyo3::prelude::*;

use crate::any_batch::AnyBatch;
use crate::equations::{self, EquationText};
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
    pub(crate) substeps: u32,
    limit: Option<u32>,
    observation_delay: [u32; 2],
    action_delay: [u32; 2],
    jitter: (String, f64),
    skew: (String, f64),
    /// Commands of discrete actions; empty for commands of any value.
    pub(crate) levels: Vec<f64>,
    pub(crate) parameter_infos: bool,
    subject: Subject,
}

/// What the environments are of.
#[derive(FromPyObject)]
enum Subject {
    #[pyo3(transparent)]
    Catalogue(CatalogueRequest),
    #[pyo3(transparent)]
    Equations(EquationRequest),
}

/// A system of the catalogue with one of the engine's tasks.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct CatalogueRequest {
    catalogued: SystemRequest,
    task: (String, Vec<f64>),
    start: [[f64; 2]; 2],
    saturation: f64,
    noise: (String, f64),
}

/// A system by equations with a task by expressions: the text of a table `[task]`, or none for that of the system's file.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct EquationRequest {
    equations: EquationText,
    task: Option<String>,
    /// Parameters that vary.
    varied: Vec<(String, NumberRequest)>,
    saturation: Vec<NumberRequest>,
    noise: Vec<(String, f64)>,
    /// Lengths of the steps of the integrator between two actions in s, where they differ.
    lengths: Vec<f64>,
    /// Ranges of the factors of errors of the clock and of noise.
    error_scale: [[f64; 2]; 2],
    /// The distribution of the time of an answer in s, and the steps of the integrator in which the system waits for it.
    answers: Option<(NumberRequest, u32)>,
}

/// The kind of a number of an episode, and its numbers.
type NumberRequest = (String, Vec<f64>);

fn episode_number((kind, numbers): &NumberRequest) -> PyResult<EpisodeNumber> {
    Ok(match (kind.as_str(), numbers.as_slice()) {
        ("constant", &[value]) => EpisodeNumber::Constant(value),
        ("uniform", &[low, high]) => EpisodeNumber::Drawn(Distribution::Uniform(low, high)),
        ("log-uniform", &[low, high]) => EpisodeNumber::Drawn(Distribution::LogUniform(low, high)),
        ("lognormal", &[mean, std]) => EpisodeNumber::Drawn(Distribution::LogNormal(mean, std)),
        ("gaussian", &[mean, std]) => EpisodeNumber::Drawn(Distribution::Normal(mean, std)),
        ("each", all) => EpisodeNumber::PerEnvironment(all.into()),
        _ => {
            let known = ["constant", "uniform", "log-uniform", "lognormal", "gaussian", "each"];
            return Err(unknown("distribution", kind, known));
        }
    })
}

fn answer_times((law, waits): &(NumberRequest, u32)) -> PyResult<AnswerTimes> {
    match episode_number(law)? {
        EpisodeNumber::Drawn(time) => Ok(AnswerTimes { time, waits: *waits }),
        _ => {
            Err(unknown("distribution of answers", &law.0, ["uniform", "log-uniform", "lognormal"]))
        }
    }
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

    /// The law of the rates of clocks.
    pub(crate) fn skew(&self) -> PyResult<Jitter> {
        law("skew", &self.skew.0, self.skew.1)
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

    /// Environments of these settings.
    pub(crate) fn batch(&self) -> PyResult<AnyBatch> {
        let batch =
            AnyBatch::new(&self.settings()?, self.single()?, self.num_envs, &self.execution()?);
        batch.map_err(Raised::raised)
    }

    fn settings(&self) -> PyResult<EnvironmentSettings> {
        let mut settings = match &self.subject {
            Subject::Catalogue(request) => request.settings(self)?,
            Subject::Equations(request) => request.settings(self)?,
        };
        let waits = settings.definition.answers.map_or(0, |answers| answers.waits);
        settings.definition = ProgramEnvironment {
            substeps: self.substeps.saturating_add(waits),
            limit: self.limit,
            autoreset: self.autoreset()?,
            delays: Delays {
                observation: self.observation_delay,
                action: self.action_delay.map(|steps| steps + waits),
            },
            skew: self.skew()?,
            jitter: law("jitter", &self.jitter.0, self.jitter.1)?,
            ..settings.definition
        };
        Ok(settings)
    }

    /// The places of the numbers of a state among positions and velocities.
    pub(crate) fn places(&self) -> PyResult<Vec<usize>> {
        match &self.subject {
            Subject::Catalogue(_) => Ok(vec![0, 1]),
            Subject::Equations(subject) => {
                let system = equations::equations(&subject.equations)?;
                Ok(system.states.iter().map(|state| state.place).collect())
            }
        }
    }
}

impl CatalogueRequest {
    fn settings(&self, common: &Settings) -> PyResult<EnvironmentSettings> {
        let CatalogueRequest { catalogued, task, start, saturation, noise } = self;
        let (system, actuation) = system(catalogued)?;
        let task = catalogued_task(task)?;
        let task = CatalogueTask::new(system, actuation, task).ok_or_else(|| {
            let name = &catalogued.0;
            value_error(format!("system is {name}, but it must have a single degree of freedom"))
        })?;
        let mut settings =
            EnvironmentSettings::of_catalogue(task, method(&common.integrator)?, common.dt);
        let noise = law("observation_noise", &noise.0, noise.1)?;
        settings.definition = ProgramEnvironment {
            start: start.to_vec(),
            saturation: vec![(*saturation).into()],
            noise: vec![noise; settings.definition.observations()],
            ..settings.definition
        };
        Ok(settings)
    }
}

impl EquationRequest {
    fn settings(&self, common: &Settings) -> PyResult<EnvironmentSettings> {
        let EquationRequest { equations: source, task, varied, saturation, noise, .. } = self;
        let names: Vec<String> = varied.iter().map(|(name, _)| name.clone()).collect();
        let system = equations::varied(source, &names)?;
        let [clock, sensor] = self.error_scale;
        let task = match task {
            Some(text) => equations::task(text, &system)?,
            None => system.task.clone().ok_or_else(|| {
                let text = "reward is required: the system has no task";
                value_error(text.to_owned())
            })?,
        };
        let noise = noise.iter().map(|(kind, rms)| law("observation_noise", kind, *rms));
        let dynamics = system.equations.dynamics().clone();
        let definition = ProgramEnvironment {
            lengths: self.lengths.clone(),
            start: task.start.clone(),
            answers: self.answers.as_ref().map(answer_times).transpose()?,
            saturation: saturation.iter().map(episode_number).collect::<PyResult<_>>()?,
            levels: task.levels.clone(),
            inner_steps: task.inner_steps(common.dt).map_err(value_error)?,
            parameters: varied
                .iter()
                .map(|(_, number)| episode_number(number))
                .collect::<PyResult<_>>()?,
            error_scale: ErrorScale { clock, sensor },
            noise: noise.collect::<PyResult<_>>()?,
            ..ProgramEnvironment::new(
                dynamics,
                task.programs.clone(),
                method(&common.integrator)?,
                common.dt,
            )
        };
        let (text, _, parameters) = source.clone();
        let subject = EquationSubject { system, text, parameters, task };
        Ok(EnvironmentSettings {
            subject: EnvironmentSubject::Equations(Box::new(subject)),
            definition,
        })
    }
}

fn catalogued_task((name, numbers): &(String, Vec<f64>)) -> PyResult<Task> {
    Ok(match (name.as_str(), numbers.as_slice()) {
        ("regulate", &[position, velocity, effort, bound]) => {
            Task::Regulate(Regulate { position, velocity, effort, bound })
        }
        ("swing-up", &[velocity, effort]) => Task::SwingUp(SwingUp { velocity, effort }),
        ("track", &[amplitude, angular_frequency, phase, position, velocity, effort, bound]) => {
            Task::Track(Track {
                reference: Sine { amplitude, angular_frequency, phase },
                regulate: Regulate { position, velocity, effort, bound },
            })
        }
        _ => return Err(unknown("task", name, ["regulate", "swing-up", "track"])),
    })
}
