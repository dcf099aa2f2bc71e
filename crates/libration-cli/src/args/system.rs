//! Options of the system, its start and its step, which several commands share.

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::path::Path;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::error::ErrorKind;
use clap::{Arg, Args, Command};
use libration::catalog::{ENTRIES, Entry};
use libration::integrator::Exact;
use libration::{AnyMethod, CatalogError, catalog};
use libration_analyze::Stepping;
use libration_settings::equations::EquationSystem;
use libration_settings::{Number, suggestions};

use super::number::{Coordinates, assignment, coordinates, time_step};
use super::quoted::quoted;
use crate::error::Failure;

/// The system, its parameters and its start.
#[derive(Args, Clone, Debug)]
pub(crate) struct SystemArgs {
    /// Name of the system, see `libration list`; or a file NAME.toml with its equations
    #[arg(long, value_name = "NAME", value_parser = NameOrFile, hide_possible_values = true)]
    pub(crate) system: Option<String>,
    /// In place of a system the acceleration of a coordinate, of q0, v0, q1, … and parameters of --set: "-k*q0 - 0.1*v0^3";
    /// once for each coordinate
    #[arg(long, value_name = "EXPRESSION", conflicts_with = "system", allow_hyphen_values = true)]
    pub(crate) force: Vec<String>,
    /// Parameter of the system, e.g. omega2=10; repeatable. With m= (kg) and k= (N/m), commands are forces
    #[arg(long, value_name = "KEY=VALUE", value_parser = assignment, allow_hyphen_values = true)]
    pub(crate) set: Vec<(String, f64)>,
    /// Initial positions, separated by commas [default: those of the system]
    #[arg(long, value_name = "Q,…", value_parser = coordinates, allow_hyphen_values = true)]
    pub(crate) q: Option<Coordinates>,
    /// Initial velocities, separated by commas [default: those of the system]
    #[arg(long, value_name = "V,…", value_parser = coordinates, allow_hyphen_values = true)]
    pub(crate) v: Option<Coordinates>,
    /// Initial states by name, separated by commas, e.g. "theta=0.1,theta'=0"; the others are those of --q and --v, or of the system
    #[arg(
        long,
        value_name = "NAME=VALUE,…",
        value_parser = assignment,
        value_delimiter = ',',
        allow_hyphen_values = true
    )]
    pub(crate) start: Vec<(String, f64)>,
}

/// The integrator and its time step.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct StepArgs {
    /// Name of the integrator, or `exact` for a linear system; see `libration list`
    #[arg(
        long,
        value_name = "NAME",
        value_parser = integrators(),
        hide_possible_values = true,
        requires = "dt",
        required = false,
        required_unless_present_any = LOOPS
    )]
    pub(crate) integrator: Stepping,
    /// Time step in s, also as 2ms or 500Hz
    #[arg(
        long,
        value_name = "SECONDS",
        value_parser = time_step,
        allow_hyphen_values = true,
        requires = "integrator",
        required = false,
        required_unless_present_any = LOOPS
    )]
    pub(crate) dt: f64,
}

/// Options of loops around plants, which have steps of their own.
const LOOPS: [&str; 4] = ["plant", "config", "lqr", "gain"];

/// A name of the catalogue, or a path with the extension `toml`.
#[derive(Clone)]
struct NameOrFile;

impl TypedValueParser for NameOrFile {
    type Value = String;

    fn parse_ref(
        &self,
        command: &Command,
        arg: Option<&Arg>,
        value: &OsStr,
    ) -> Result<String, clap::Error> {
        match value.to_str() {
            Some(path) if is_file(path) => Ok(path.to_owned()),
            _ => system_names().parse_ref(command, arg, value),
        }
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new(
            ENTRIES.map(|entry| PossibleValue::new(entry.name).help(entry.summary)).into_iter(),
        ))
    }
}

/// Whether the value of `--system` is a file of equations.
pub(super) fn is_file(system: &str) -> bool {
    Path::new(system).extension().is_some_and(|extension| extension == "toml")
}

impl SystemArgs {
    /// The file of equations, if `--system` names one.
    pub(crate) fn file(&self) -> Option<&Path> {
        self.system.as_deref().filter(|system| is_file(system)).map(Path::new)
    }

    /// Whether the system is one of the catalogue, by its name.
    pub(crate) fn is_of_catalogue(&self) -> bool {
        self.file().is_none() && self.force.is_empty()
    }

    /// The parameters of `--set` for a system by equations.
    ///
    /// # Errors
    /// If one is given twice or is not finite.
    pub(crate) fn equation_parameters(&self) -> Result<BTreeMap<String, Number>, Failure> {
        let mut all = BTreeMap::new();
        for (name, value) in &self.set {
            let expected = match value.is_finite() {
                false => "expected a finite number",
                true if all.insert(name.clone(), Number(*value)).is_some() => {
                    "the parameter is given twice; expected once"
                }
                true => continue,
            };
            return Err(Failure::usage(format!("--set {name}={value}: {expected}")));
        }
        Ok(all)
    }

    /// The options as words of a command line.
    pub(crate) fn words(&self) -> String {
        let SystemArgs { system, force, set, q, v, start } = self;
        let mut words = Vec::new();
        let mut option = |name: &str, value: String| words.extend([name.to_owned(), value]);
        system.iter().for_each(|name| option("--system", name.clone()));
        force.iter().for_each(|text| option("--force", text.clone()));
        set.iter().for_each(|(name, value)| option("--set", format!("{name}={value}")));
        q.iter().for_each(|list| option("--q", list.to_string()));
        v.iter().for_each(|list| option("--v", list.to_string()));
        start.iter().for_each(|(name, value)| option("--start", format!("{name}={value}")));
        quoted(words)
    }

    /// Returns the system and its start. Missing values are those of the catalogue.
    ///
    /// # Errors
    /// If a parameter is unknown or not allowed, or the number of coordinates is wrong.
    pub(crate) fn resolve(&self) -> Result<EquationSystem, Failure> {
        if !self.force.is_empty() {
            return Err(Failure::usage(
                "--force: this command takes systems of the catalogue; `simulate` and `analyze` take expressions",
            ));
        }
        let Some(name) = &self.system else { return Err(Failure::usage("--system is required")) };
        if self.file().is_some() {
            return Err(Failure::usage(format!(
                "--system `{0}`: this command takes systems of the catalogue; a file of equations is a plant, linearised at an equilibrium: --plant {0}",
                name
            )));
        }
        let (system, actuation) = catalog::build(name, &self.set).map_err(wrong_parameter)?;
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
        let [q, v] = [&self.q, &self.v].map(|given| given.as_ref().map(Coordinates::values));
        let mut begun =
            EquationSystem::of_catalogue((system, actuation), q, v).map_err(Failure::usage)?;
        begun.begin_at(None, None, &self.start).map_err(Failure::usage)?;
        Ok(begun)
    }
}

fn wrong_parameter(error: CatalogError) -> Failure {
    Failure::usage(format!("{error}{} (--set)", suggestions::catalog_help(&error)))
}

fn wrong_count(entry: &Entry, flag: &str, given: &Coordinates) -> Failure {
    let needed = match (entry.dimensions.start(), entry.dimensions.end()) {
        (1, 1) => "1 number".to_owned(),
        (low, high) if low == high => format!("{low} numbers, separated by commas"),
        (low, high) => format!("{low} to {high} numbers, separated by commas"),
    };
    let (name, count) = (entry.name, given.0.len());
    let noun = if count == 1 { "coordinate" } else { "coordinates" };
    Failure::usage(format!("{flag} `{given}` has {count} {noun}; {name} requires {needed}"))
}

fn unequal_counts(q: &Coordinates, v: &Coordinates) -> Failure {
    let (of_q, of_v) = (q.0.len(), v.0.len());
    Failure::usage(format!(
        "--q `{q}` has {of_q} coordinates and --v `{v}` has {of_v}; expected equal numbers"
    ))
}

fn system_names() -> PossibleValuesParser {
    let value = |entry: &Entry| PossibleValue::new(entry.name).help(entry.summary);
    PossibleValuesParser::new(ENTRIES.map(value))
}

pub(super) fn integrators() -> impl TypedValueParser<Value = Stepping> {
    IntegratorParser
}

/// Names of integrators. Messages list those with code of their own and the nearest of all.
#[derive(Clone)]
struct IntegratorParser;

impl TypedValueParser for IntegratorParser {
    type Value = Stepping;

    fn parse_ref(
        &self,
        command: &Command,
        _: Option<&Arg>,
        value: &OsStr,
    ) -> Result<Stepping, clap::Error> {
        let name = value.to_string_lossy();
        Stepping::from_name(&name).ok_or_else(|| {
            let all = AnyMethod::all().chain(AnyMethod::tables()).map(AnyMethod::name);
            let near = suggestions::nearest(&name, all.chain([Stepping::EXACT]));
            let near = near.map_or_else(String::new, |near| format!("did you mean `{near}`? "));
            let listed = AnyMethod::all().map(AnyMethod::name);
            let listed: Vec<&str> = listed.chain([Stepping::EXACT]).collect();
            let text = format!(
                "invalid value '{name}' for '--integrator <NAME>': {near}expected one of {}, or a published method of `libration list`\n",
                listed.join(", ")
            );
            clap::Error::raw(ErrorKind::InvalidValue, text).with_cmd(command)
        })
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        let value = |method: AnyMethod| PossibleValue::new(method.name()).help(method.summary());
        let exact = PossibleValue::new(Stepping::EXACT).help(Exact::SUMMARY);
        Some(Box::new(AnyMethod::all().chain(AnyMethod::tables()).map(value).chain([exact])))
    }
}

#[cfg(test)]
mod tests;
