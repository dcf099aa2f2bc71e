//! Conversion of the tables of a settings file into settings.

use libration::catalog::Actuation;
use libration::control::Jitter;
use libration::rl::task::{Regulate, Sine, SwingUp, Track};
use libration::rl::{Autoreset, Delays};
use libration::{Method, catalog};
use libration_analyze::trajectory::FloatType;
use libration_settings::limits::{TIME_STEP, within};
use libration_settings::{Count, Fault, Number, suggestions};

use super::settings::{Chunk, Dataset, STEPS};
use super::tables::{File, PolicyTable, TaskTable};
use crate::environments::{EnvironmentSettings, Noise, PolicySettings, SingleDofSystem, Task};

/// Checks that `count` is in a range.
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

/// Checks that `number` is finite.
fn finite(key: &'static str, Number(number): Number) -> Result<f64, Fault> {
    if number.is_finite() {
        return Ok(number);
    }
    Err(Fault::new(key, format!("`{key}` is {number:?}, but it must be finite")))
}

/// Checks that `number` is finite and not negative.
fn non_negative(key: &'static str, Number(number): Number) -> Result<f64, Fault> {
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
            fault.help(suggestions::suggest("integrators", name, Method::ALL.map(Method::name)))
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
        let (lone, actuation) = system(&file)?;
        let rms = |key, number| Ok(Jitter::Gaussian(non_negative(key, number)?));
        Ok(Dataset {
            seed: count("seed", file.seed, 0..=u64::MAX)?,
            float,
            environments: count("environments", file.environments, 1..=1_000_000_000)? as usize,
            steps: count("steps", file.steps, 1..=STEPS)?,
            chunk: Chunk {
                environments: count("chunk.environments", file.chunk.environments, 1..=1_000_000)?
                    as usize,
                steps: count("chunk.steps", file.chunk.steps, 1..=1_000_000)? as usize,
            },
            environment: EnvironmentSettings {
                system: lone,
                actuation,
                method,
                dt,
                substeps: count("substeps", file.substeps, 1..=1_000_000)? as u32,
                task,
                start: [ends("start.q", file.start.q)?, ends("start.v", file.start.v)?],
                limit: Some(limit).filter(|&limit| limit > 0),
                autoreset: Autoreset::SameStep,
                delays: Delays { observation: observation?, action: action? },
                saturation: f64::INFINITY,
                noise: Noise {
                    jitter: rms("noise.jitter", file.noise.jitter)?,
                    skew: rms("noise.skew", file.noise.skew)?,
                    observation: rms("noise.observation", file.noise.observation)?,
                },
            },
            policy: policy(file.policy, task.observations())?,
        })
    }
}

fn system(file: &File) -> Result<(SingleDofSystem, Actuation), Fault> {
    let mut systems = file.system.iter();
    let (Some((name, parameters)), None) = (systems.next(), systems.next()) else {
        return Err(Fault::new("system", "`system` must be one table, as [system.oscillator]"));
    };
    let parameters: Vec<_> = parameters.iter().map(|(name, value)| (name, value.0)).collect();
    let (system, actuation) = catalog::build(name, &parameters)
        .map_err(|error| Fault::new("system", error.to_string()))?;
    let lone = SingleDofSystem::new(system).ok_or_else(|| {
        let message =
            format!("`{name}` does not have a single degree of freedom, as a data set requires");
        Fault::new("system", message)
    })?;
    Ok((lone, actuation))
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

fn policy(table: PolicyTable, seen: usize) -> Result<PolicySettings, Fault> {
    let key = "policy";
    Ok(match table {
        PolicyTable::Linear(t) => {
            if t.weights.len() != seen {
                let found = t.weights.len();
                let message = format!(
                    "`weights` has {found} numbers, but it must have {seen}: one per observation"
                );
                return Err(Fault::new("policy.linear.weights", message));
            }
            let weights = t.weights.into_iter().map(|weight| finite(key, weight));
            PolicySettings::Linear {
                weights: weights.collect::<Result<_, _>>()?,
                bias: finite(key, t.bias)?,
            }
        }
        PolicyTable::Random(t) => {
            let (low, high) = (finite(key, t.low)?, finite(key, t.high)?);
            if low >= high {
                let message = format!(
                    "`low` is {low:?} and `high` is {high:?}, but `low` must be below `high`"
                );
                return Err(Fault::new(key, message));
            }
            PolicySettings::Random { low, high }
        }
        PolicyTable::Constant(t) => PolicySettings::Constant(finite(key, t.action)?),
    })
}
