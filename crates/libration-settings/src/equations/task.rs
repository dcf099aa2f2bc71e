//! Tasks of environments by expressions, in files.

use std::collections::BTreeMap;
use std::ops::Range;

use libration::equations::{EquationError, EquationErrorKind, TaskDefinitions, TaskPrograms};
use serde::Deserialize;
use serde::de::IgnoredAny;
use toml::Spanned;

use super::EquationSystem;
use super::expression_error::{help, inside};
use super::table::Wrong;
use crate::duration::Period;
use crate::{Document, Number, SettingsError, suggestions};

/// A task on a system by equations: what is observed, the reward, when an episode is over, and where it starts.
#[derive(Clone, Debug, PartialEq)]
pub struct EquationTask {
    /// The texts of the expressions.
    pub definitions: TaskDefinitions,
    /// The programs.
    pub programs: TaskPrograms,
    /// The unit of each observed number; empty where it is not known.
    pub units: Vec<String>,
    /// The range of each position, then of each velocity, from which an episode starts.
    pub start: Vec<[f64; 2]>,
    /// The commands of discrete actions, in ascending order; empty for commands of any value.
    pub levels: Vec<f64>,
    /// The period of the inner controller in seconds; without one it takes every step of the integrator.
    pub inner_period: Option<f64>,
}

/// A file with a task.
#[derive(Deserialize)]
struct File {
    #[serde(rename = "system", default)]
    _system: IgnoredAny,
    task: TaskTable,
}

/// The table `[task]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TaskTable {
    observe: Option<Vec<Spanned<String>>>,
    reward: Spanned<String>,
    #[serde(default)]
    terminated: Vec<Spanned<String>>,
    #[serde(default)]
    start: BTreeMap<Spanned<String>, Spanned<Start>>,
    #[serde(default)]
    project: BTreeMap<Spanned<String>, Spanned<String>>,
    actions: Option<Spanned<Vec<Number>>>,
    #[serde(default)]
    targets: Vec<Spanned<String>>,
    #[serde(default)]
    inner: BTreeMap<Spanned<String>, Spanned<String>>,
    inner_period: Option<Spanned<Period>>,
}

/// A number, or the ends of a range.
#[derive(Clone, Copy, Deserialize)]
#[serde(untagged, expecting = "expected a number, or the two ends of a range")]
enum Start {
    At(Number),
    Between([Number; 2]),
}

impl EquationTask {
    /// Reads a task on `system` from the table `[task]` of a file; `file` is its name in messages.
    ///
    /// # Errors
    /// The first key or expression that is wrong.
    pub fn parse(text: &str, file: &str, system: &EquationSystem) -> Result<Self, SettingsError> {
        let document = Document::parse(text, file)?;
        let File { task, .. } = toml::from_str(text).map_err(|error| document.explain(&error))?;
        task.read(system, text)
            .map_err(|(span, message, help)| SettingsError::new(file, text, span, message, help))
    }
}

impl EquationTask {
    /// The period of the inner controller in steps of `dt` seconds.
    ///
    /// # Errors
    /// If it is not a whole number of them.
    pub fn inner_steps(&self, dt: f64) -> Result<u32, String> {
        let Some(period) = self.inner_period else { return Ok(1) };
        let steps = period / dt;
        // The quotient of two doubles is accurate to some 1e-16; 1e-9 of a step is no intended fraction.
        if steps.round() >= 1.0 && steps < 1e9 && (steps - steps.round()).abs() <= 1e-9 * steps {
            return Ok(steps.round() as u32);
        }
        Err(format!(
            "`inner_period` is {period} s; expected whole steps of the integrator of {dt} s"
        ))
    }
}

impl TaskTable {
    /// The task on a system; `text` is that of the file.
    pub(super) fn read(&self, system: &EquationSystem, text: &str) -> Result<EquationTask, Wrong> {
        let texts = |all: &[Spanned<String>]| -> Vec<String> {
            all.iter().map(|text| text.get_ref().clone()).collect()
        };
        let states = || system.states.iter().map(|state| state.name.clone()).collect();
        let definitions = TaskDefinitions {
            observe: self.observe.as_deref().map_or_else(states, texts),
            reward: self.reward.get_ref().clone(),
            terminated: texts(&self.terminated),
            project: pairs(&self.project),
            targets: texts(&self.targets),
            inner: pairs(&self.inner),
        };
        if definitions.observe.is_empty() {
            let span = self.reward.span();
            let message = "`observe` is empty; expected at least one expression, or no `observe` for all states";
            return Err((span, message.into(), None));
        }
        let programs = TaskPrograms::new(&definitions, &system.definitions, &system.equations)
            .map_err(|error| (self.place(&error, text), error.to_string(), help(&error)))?;
        let unit = |text: &String| {
            let state = system.states.iter().find(|state| state.name == *text);
            state.map_or_else(String::new, |state| state.unit.clone())
        };
        Ok(EquationTask {
            units: definitions.observe.iter().map(unit).collect(),
            start: self.start(system)?,
            levels: self.levels(definitions.actions(&system.definitions).len())?,
            inner_period: self.inner_period()?,
            definitions,
            programs,
        })
    }

    /// The period of the inner controller.
    fn inner_period(&self) -> Result<Option<f64>, Wrong> {
        let Some(period) = &self.inner_period else { return Ok(None) };
        let seconds = period.get_ref().0;
        let message = if self.inner.is_empty() {
            "`inner_period` belongs to an inner controller; expected a table `inner`".to_owned()
        } else if !(seconds > 0.0 && seconds.is_finite()) {
            format!("`inner_period` is {seconds} s; expected a finite number above 0")
        } else {
            return Ok(Some(seconds));
        };
        Err((period.span(), message, None))
    }

    /// The commands of discrete actions.
    fn levels(&self, inputs: usize) -> Result<Vec<f64>, Wrong> {
        let Some(actions) = &self.actions else { return Ok(Vec::new()) };
        let levels: Vec<f64> = actions.get_ref().iter().map(|x| x.0).collect();
        let message = if inputs != 1 {
            format!("`actions` are commands of one input, but there are {inputs}")
        } else if levels.len() < 2 {
            format!("`actions` has {} commands; expected at least two", levels.len())
        } else if levels.iter().any(|level| !level.is_finite())
            || !levels.is_sorted_by(|a, b| a < b)
        {
            format!("`actions` is {levels:?}; expected finite numbers in ascending order")
        } else {
            return Ok(levels);
        };
        Err((actions.span(), message, None))
    }

    /// The place in the file of an error of an expression.
    fn place(&self, error: &EquationError, text: &str) -> Range<usize> {
        let place =
            |value: &Spanned<String>| inside(value, error, text).unwrap_or_else(|| value.span());
        let mut keys = error.key.split('.').skip(1);
        let (key, index) = (keys.next(), keys.next().and_then(|index| index.parse().ok()));
        let tables = [("project", &self.project), ("inner", &self.inner)];
        if let Some((key, table)) = tables.into_iter().find(|(table, _)| key == Some(*table)) {
            let name = error.key.trim_start_matches("task.").trim_start_matches(key);
            let name = name.trim_start_matches('.');
            let entry = table.iter().find(|(known, _)| known.get_ref() == name);
            let unknown = matches!(error.kind, EquationErrorKind::UnknownName { .. });
            return match entry {
                Some((key, _)) if unknown && error.span.is_none() => key.span(),
                Some((_, text_of)) => place(text_of),
                None => table.keys().next().map_or(self.reward.span(), Spanned::span),
            };
        }
        if key == Some("targets") {
            return self.targets.first().map_or(self.reward.span(), Spanned::span);
        }
        let texts = match key {
            Some("observe") => self.observe.as_deref().unwrap_or_default(),
            Some("terminated") => &self.terminated[..],
            _ => std::slice::from_ref(&self.reward),
        };
        texts.get(index.unwrap_or(0)).map_or(self.reward.span(), place)
    }

    /// The ranges of positions and velocities; those that are not given start where the system does.
    fn start(&self, system: &EquationSystem) -> Result<Vec<[f64; 2]>, Wrong> {
        let mut ranges: Vec<[f64; 2]> = system.q.iter().chain(&system.v).map(|&x| [x, x]).collect();
        for (name, start) in &self.start {
            let Some(state) = system.states.iter().find(|state| state.name == *name.get_ref())
            else {
                let known = system.states.iter().map(|state| state.name.as_str());
                let help = suggestions::suggest("states", name.get_ref(), known);
                return Err((
                    name.span(),
                    format!("unknown state `{}`", name.get_ref()),
                    Some(help),
                ));
            };
            let [low, high] = match *start.get_ref() {
                Start::At(x) => [x.0; 2],
                Start::Between(ends) => ends.map(|x| x.0),
            };
            if !(low <= high && (high - low).is_finite()) {
                let message = format!(
                    "`{}` starts from {low:?} to {high:?}; expected numbers with a finite distance, of which the first is not the larger",
                    name.get_ref()
                );
                return Err((start.span(), message, None));
            }
            ranges[state.place] = [low, high];
        }
        Ok(ranges)
    }
}

/// Names and texts, in the order of the file.
fn pairs(table: &BTreeMap<Spanned<String>, Spanned<String>>) -> Vec<(String, String)> {
    let mut entries: Vec<_> = table.iter().collect();
    entries.sort_by_key(|(name, _)| name.span().start);
    entries
        .into_iter()
        .map(|(name, text)| (name.get_ref().clone(), text.get_ref().clone()))
        .collect()
}
