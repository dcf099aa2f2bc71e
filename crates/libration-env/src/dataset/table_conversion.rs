//! Conversion of the tables of a settings file into settings.

use libration::control::Jitter;
use libration::rl::task::{Regulate, Sine, SwingUp, Track};
use libration::rl::{Delays, ProgramEnvironment};
use libration::{ImplicitMethod, Method};
use libration_analyze::trajectory::FloatType;
use libration_settings::limits::{TIME_STEP, within};
use libration_settings::{
    Coordinates, Count, Fault, Number, StartTable, SystemTables, suggestions,
};

use super::delay_steps::{check_delays, delay_steps};
use super::equation_tables::equation_environment;
use super::settings::{Chunk, Dataset, STEPS};
use super::system_tables::{EquationsTable, Numbers};
use super::tables::{ConstantTable, File, PolicyTable, TaskTable};
use crate::environments::{
    CatalogueTask, EnvironmentSettings, EnvironmentSubject, Noise, PolicySettings, Task,
};

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
        let known = |float: &FloatType| [float.name(), float.dtype()].contains(&&*file.dtype);
        let dtype = [FloatType::F32, FloatType::F64].into_iter().find(known).ok_or_else(|| {
            let message = format!("`dtype` is `{}`, but it must be `f32` or `f64`", file.dtype);
            Fault::new("dtype", message)
        })?;
        let name = &file.integrator;
        let method = Method::from_name(name).ok_or_else(|| {
            let message = match ImplicitMethod::from_name(name) {
                Some(_) => {
                    format!("`integrator` is `{name}`, which is implicit, but it must be explicit")
                }
                None => format!("unknown integrator `{name}`"),
            };
            let fault = Fault::new("integrator", message);
            fault.help(suggestions::suggest("integrators", name, Method::ALL.map(Method::name)))
        })?;
        let dt = within(TIME_STEP, "dt", file.dt.0).map_err(|why| Fault::new("dt", why))?;
        let limit = count("max_episode_steps", file.max_episode_steps, 0..=u32::MAX.into())? as u32;
        let [observation, action] = [
            ("delays.observation", file.delays.observation),
            ("delays.action", file.delays.action),
        ]
        .map(|(key, range)| delay_steps(key, range, dt));
        let ends = |key, given: Option<Coordinates>, default: f64| -> Result<[f64; 2], Fault> {
            let ends = match given.map_or(vec![default], Coordinates::list)[..] {
                [one] => [one; 2],
                [low, high] => [low, high],
                ref all => {
                    let message = format!(
                        "`{key}` has {} numbers; expected one, or the two ends of an interval",
                        all.len()
                    );
                    return Err(Fault::new(key, message));
                }
            };
            let [low, high] = ends.map(|end| finite(key, Number(end)));
            let (low, high) = (low?, high?);
            if low > high {
                let message = format!("`{key}` is from {low:?} to {high:?}, but it must rise");
                return Err(Fault::new(key, message));
            }
            Ok([low, high])
        };
        let rms = |key, number| Ok(Jitter::Gaussian(non_negative(key, number)?));
        let noise = Noise {
            jitter: rms("noise.jitter", file.noise.jitter)?,
            skew: rms("noise.skew", file.noise.skew)?,
            observation: rms("noise.observation", file.noise.observation)?,
        };
        let delays = Delays { observation: observation?, action: action? };
        let substeps = count("substeps", file.substeps, 1..=1_000_000)? as u32;
        let limit = Some(limit).filter(|&limit| limit > 0);
        check_delays(&delays, limit, substeps, dt)?;
        let mut environment = match &file.system.equations {
            None => {
                let StartTable { q, v } = file.start.unwrap_or_default();
                let task = catalogue_task(&file.system, file.task.unwrap_or_default())?;
                let mut environment = EnvironmentSettings::of_catalogue(task, method, dt);
                environment.definition.start =
                    vec![ends("start.q", q, 1.0)?, ends("start.v", v, 0.0)?];
                environment
            }
            Some(equations) => {
                if file.start.is_some() {
                    let message = "`start` belongs to systems of the catalogue; expected `start` in [task.expressions], by the names of states";
                    return Err(Fault::new("start", message));
                }
                file.system.check_single()?;
                equation_environment(equations, file.task, (method, dt))?
            }
        };
        environment.definition = ProgramEnvironment {
            substeps,
            limit,
            delays,
            skew: noise.skew,
            jitter: noise.jitter,
            noise: vec![noise.observation; environment.definition.observations()],
            ..environment.definition
        };
        let sizes = [environment.observed().len(), environment.actions().len()];
        // The default of the catalogue is for an oscillator.
        let default = match &environment.subject {
            EnvironmentSubject::Catalogue(_) => PolicyTable::default(),
            EnvironmentSubject::Equations(_) => PolicyTable::Constant(ConstantTable::default()),
        };
        let acting = policy(file.policy.unwrap_or(default), sizes)?;
        Ok(Dataset {
            seed: count("seed", file.seed, 0..=u64::MAX)?,
            float: dtype,
            environments: count("num_envs", file.num_envs, 1..=1_000_000_000)? as usize,
            steps: count("steps", file.steps, 1..=STEPS)?,
            chunk: Chunk {
                environments: count("chunk.num_envs", file.chunk.num_envs, 1..=1_000_000)? as usize,
                steps: count("chunk.steps", file.chunk.steps, 1..=1_000_000)? as usize,
            },
            environment,
            policy: acting,
        })
    }
}

/// What to do about linear plants, in messages.
const OTHER_SYSTEMS: &str = "[system.equations] has systems by equations";

/// A number for each action.
pub(super) fn each(
    key: &'static str,
    numbers: Numbers,
    actions: usize,
    holds: fn(f64) -> bool,
    allowed: &str,
) -> Result<Vec<f64>, Fault> {
    let all: Vec<f64> = match numbers {
        Numbers::One(x) => vec![x.0; actions],
        Numbers::Each(all) => all.into_iter().map(|x| x.0).collect(),
    };
    if all.len() != actions {
        let found = all.len();
        let message = format!(
            "`{key}` has {found} numbers; expected one, or one for each of {actions} actions"
        );
        return Err(Fault::new(key, message));
    }
    match all.iter().find(|x| !holds(**x)) {
        Some(x) => Err(Fault::new(key, format!("`{key}` is {x:?}; expected a number {allowed}"))),
        None => Ok(all),
    }
}

fn catalogue_task(
    tables: &SystemTables<EquationsTable>,
    table: TaskTable,
) -> Result<CatalogueTask, Fault> {
    let (system, actuation) = tables.build(OTHER_SYSTEMS)?;
    CatalogueTask::new(system, actuation, task(table)?).ok_or_else(|| {
        let name = system.name();
        let message =
            format!("`{name}` does not have a single degree of freedom, as a data set requires");
        Fault::new("system", message)
    })
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
        TaskTable::Expressions(_) => {
            let message =
                "a task by expressions needs a system by equations; expected [system.equations]";
            return Err(Fault::new("task", message));
        }
    })
}

fn policy(table: PolicyTable, [seen, actions]: [usize; 2]) -> Result<PolicySettings, Fault> {
    let finite_each = |numbers| each("policy", numbers, actions, f64::is_finite, "that is finite");
    Ok(match table {
        PolicyTable::Linear(t) => {
            let weights = t.weights.flat();
            if weights.len() != seen * actions {
                let (found, wanted) = (weights.len(), seen * actions);
                let rows = if actions == 1 { "" } else { ", a row for each action" };
                let message = format!(
                    "`weights` has {found} numbers, but it must have {wanted}: one per observation{rows}"
                );
                return Err(Fault::new("policy.linear.weights", message));
            }
            let weights = weights.into_iter().map(|weight| finite("policy", Number(weight)));
            PolicySettings::Linear {
                weights: weights.collect::<Result<_, _>>()?,
                bias: finite_each(t.bias)?,
            }
        }
        PolicyTable::Random(t) => {
            let (low, high) = (finite_each(t.low)?, finite_each(t.high)?);
            if let Some((low, high)) = low.iter().zip(&high).find(|(low, high)| low >= high) {
                let message = format!(
                    "`low` is {low:?} and `high` is {high:?}, but `low` must be below `high`"
                );
                return Err(Fault::new("policy", message));
            }
            PolicySettings::Random { low, high }
        }
        PolicyTable::Constant(t) => PolicySettings::Constant(finite_each(t.action)?),
    })
}
