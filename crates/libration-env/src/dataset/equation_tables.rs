//! Conversion of the tables of a system by equations.

use std::path::Path;

use libration::Method;
use libration::rl::{EpisodeNumber, ProgramEnvironment};
use libration_settings::equations::{EquationSystem, EquationTask};
use libration_settings::{Fault, Number, SettingsError};

use super::system_tables::{EquationsTable, Numbers};
use super::table_conversion::each;
use super::tables::TaskTable;
use crate::environments::{EnvironmentSettings, EnvironmentSubject, EquationSubject};

/// The columns that each data set has.
const COLUMNS: [&str; 8] =
    ["step", "environment", "reward", "terminated", "truncated", "return", "length", "lost"];

/// Environments of a system by equations, ideal and without limits but of the actions.
pub(super) fn equation_environment(
    table: &EquationsTable,
    task: Option<TaskTable>,
    (method, dt): (Method, f64),
) -> Result<EnvironmentSettings, Fault> {
    let fault = |why: String| Fault::new("system.equations", why);
    let (text, file) = match (&table.of, &table.text) {
        (Some(path), None) => {
            let wrong = |error| fault(format!("cannot read `{path}`: {error}"));
            (libration_settings::read_text(Path::new(path)).map_err(wrong)?, path.as_str())
        }
        (None, Some(text)) => (text.clone(), table.name.as_deref().unwrap_or("text")),
        _ => return Err(fault("[system.equations] requires `of`, the name of a file".to_owned())),
    };
    let parameters: Vec<(String, f64)> =
        table.parameters.iter().map(|(name, value)| (name.clone(), value.0)).collect();
    let wrong = |error: SettingsError| format!("cannot use `{file}`: {}", error.sentence());
    let system = EquationSystem::parse(&text, file, &parameters).map_err(|e| fault(wrong(e)))?;
    let task = match task {
        None => system.task.clone().ok_or_else(|| {
            let message = format!(
                "`{file}` has no table [task]; expected [task.expressions] in the settings"
            );
            Fault::new("task", message)
        })?,
        Some(TaskTable::Expressions(table)) => {
            let mut whole = toml::Table::new();
            whole.insert("task".to_owned(), table.into());
            EquationTask::parse(&whole.to_string(), "task", &system).map_err(|error| {
                let help = error.help().map_or_else(String::new, |help| format!("; help: {help}"));
                Fault::new("task", format!("[task.expressions]: {}{help}", error.message()))
            })?
        }
        Some(_) => {
            let message = "a system by equations has a task by expressions; expected [task.expressions], or no task for that of its file";
            return Err(Fault::new("task", message));
        }
    };
    if system.equations.inputs().is_empty() {
        let message = format!("`{file}` has no inputs, but actions need at least one");
        return Err(fault(message));
    }
    let actions = task.definitions.actions(&system.definitions);
    let columns = task.definitions.observe.iter().chain(actions);
    let mut known: Vec<&str> = COLUMNS.to_vec();
    for name in columns {
        if known.contains(&name.as_str()) {
            let message = format!(
                "`{name}` is the name of a column already; expected observations and inputs with names of their own, as in [task.expressions] observe = [\"1*{name}\"]"
            );
            return Err(Fault::new("task", message));
        }
        known.push(name);
    }
    let dynamics = system.equations.dynamics().clone();
    let ideal = ProgramEnvironment::new(dynamics, task.programs.clone(), method, dt);
    let most = table.max_action.clone().unwrap_or(Numbers::One(Number(f64::INFINITY)));
    let saturation =
        each("system.equations.max_action", most, actions.len(), |x| x > 0.0, "above 0")?;
    if saturation.iter().any(|most| most.is_finite()) && !task.levels.is_empty() {
        let message = "`max_action` is given, but discrete `actions` have commands of their own";
        return Err(Fault::new("system.equations.max_action", message));
    }
    let definition = ProgramEnvironment {
        start: task.start.clone(),
        saturation: saturation.into_iter().map(EpisodeNumber::from).collect(),
        levels: task.levels.clone(),
        inner_steps: task.inner_steps(dt).map_err(|message| Fault::new("task", message))?,
        ..ideal
    };
    let subject = EquationSubject { system, text, parameters, task };
    Ok(EnvironmentSettings {
        subject: EnvironmentSubject::Equations(Box::new(subject)),
        definition,
    })
}
