//! The flags that choose a system, a start and a step; shared by the commands that simulate.

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use libration::catalog::{ENTRIES, Entry};
use libration::integrator::Exact;
use libration::{CatalogError, Method, catalog};
use libration_analyze::analyze::Stepping;
use libration_settings::names;
use libration_settings::setting::Setting;

use super::number::{Coordinates, assignment, coordinates, time_step};
use crate::error::Failure;

/// Which system, with which parameters, from where.
#[derive(Args, Clone, Debug)]
pub(crate) struct SystemArgs {
    /// The system; `libration list` shows them with their parameters
    #[arg(long, value_name = "NAME", value_parser = system_names(), hide_possible_values = true)]
    pub(crate) system: String,
    /// A parameter of the system, as in `omega2=10`; may be repeated. `m` takes `k` with it, in kg and N/m: commands are then forces
    #[arg(long, value_name = "KEY=VALUE", value_parser = assignment, allow_hyphen_values = true)]
    pub(crate) set: Vec<(String, f64)>,
    /// Positions at the start, separated by commas [default: the system's own]
    #[arg(long, value_name = "Q,…", value_parser = coordinates, allow_hyphen_values = true)]
    pub(crate) q: Option<Coordinates>,
    /// Velocities at the start, separated by commas [default: the system's own]
    #[arg(long, value_name = "V,…", value_parser = coordinates, allow_hyphen_values = true)]
    pub(crate) v: Option<Coordinates>,
}

/// Which integrator, with which time step.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct StepArgs {
    /// The integrator (`libration list` shows them), or `exact`: steps of a linear system without error
    #[arg(long, value_name = "NAME", value_parser = integrators(), hide_possible_values = true)]
    pub(crate) integrator: Stepping,
    /// Time step in s
    #[arg(long, value_name = "SECONDS", value_parser = time_step, allow_hyphen_values = true)]
    pub(crate) dt: f64,
}

impl SystemArgs {
    /// The system and its start; what is not given comes from the catalogue.
    ///
    /// # Errors
    /// Wrong input: a parameter that is unknown or not allowed, or a wrong number of coordinates.
    pub(crate) fn resolve(&self) -> Result<Setting, Failure> {
        let (system, actuation) =
            catalog::build(&self.system, &self.set).map_err(wrong_parameter)?;
        let entry = system.entry();
        for (flag, given) in [("--q", &self.q), ("--v", &self.v)] {
            match given {
                Some(given) if !entry.dimensions.contains(&given.0.len()) => {
                    return Err(wrong_count(entry, flag, given));
                }
                _ => {}
            }
        }
        if let (Some(q), Some(v)) = (&self.q, &self.v)
            && q.0.len() != v.0.len()
        {
            return Err(unequal_counts(q, v));
        }
        let given = |x: &Option<Coordinates>| x.as_ref().map(|x| x.0.clone());
        Setting::new((system, actuation), given(&self.q), given(&self.v)).map_err(Failure::usage)
    }
}

fn wrong_parameter(error: CatalogError) -> Failure {
    Failure::usage(format!("{error}{} (--set)", names::meant(&error)))
}

fn wrong_count(entry: &Entry, flag: &str, given: &Coordinates) -> Failure {
    let needed = match (entry.dimensions.start(), entry.dimensions.end()) {
        (1, 1) => "1 number".to_owned(),
        (low, high) if low == high => format!("{low} numbers, separated by commas"),
        (low, high) => format!("{low} to {high} numbers, separated by commas"),
    };
    let (name, count) = (entry.name, given.0.len());
    let noun = if count == 1 { "coordinate" } else { "coordinates" };
    Failure::usage(format!("{flag} `{given}` has {count} {noun}, but {name} takes {needed}"))
}

fn unequal_counts(q: &Coordinates, v: &Coordinates) -> Failure {
    let (of_q, of_v) = (q.0.len(), v.0.len());
    Failure::usage(format!(
        "--q `{q}` and --v `{v}` have {of_q} and {of_v} coordinates, but they must have equally many"
    ))
}

fn system_names() -> PossibleValuesParser {
    let value = |entry: &Entry| PossibleValue::new(entry.name).help(entry.summary);
    PossibleValuesParser::new(ENTRIES.map(value))
}

fn integrators() -> impl TypedValueParser<Value = Stepping> {
    let value = |method: Method| PossibleValue::new(method.name()).help(method.summary());
    let exact = PossibleValue::new(Stepping::EXACT).help(Exact::SUMMARY);
    PossibleValuesParser::new(Method::ALL.map(value).into_iter().chain([exact]))
        .try_map(|name| Stepping::from_name(&name).ok_or("unknown integrator"))
}

#[cfg(test)]
mod tests;
