//! Files of equations.

use std::fmt::Display;
use std::path::Path;

use libration_settings::equations::EquationSystem;

use crate::args::{Coordinates, SystemArgs};
use crate::error::Failure;

/// Reads the system of the equations in a file, with other values of some parameters.
pub(super) fn read(path: &Path, set: &[(String, f64)]) -> Result<EquationSystem, Failure> {
    let wrong = |why: &dyn Display| {
        Failure::usage(format!("cannot read `{}` (--system): {why}", path.display()))
    };
    let text = libration_settings::read_text(path).map_err(|error| wrong(&error))?;
    EquationSystem::parse(&text, &path.to_string_lossy(), set)
        .map_err(|error| Failure::Shown(error.render_styled()))
}

/// The system of equations of `--system FILE` or `--force`; none of the catalogue.
pub(super) fn system(options: &SystemArgs) -> Option<Result<EquationSystem, Failure>> {
    if options.is_of_catalogue() {
        return None;
    }
    if let Some(error) = options.equation_parameters().err() {
        return Some(Err(error));
    }
    let system = match options.file() {
        Some(file) => read(file, &options.set),
        None => by_forces(options),
    };
    Some(system.and_then(|mut system| {
        let [q, v] = [&options.q, &options.v].map(|given| given.as_ref().map(Coordinates::values));
        system.begin_at(q, v, &options.start).map_err(Failure::usage)?;
        Ok(system)
    }))
}

/// The system of the options, whatever describes it.
pub(super) fn any_system(options: &SystemArgs) -> Result<EquationSystem, Failure> {
    match system(options) {
        Some(system) => system,
        None => options.resolve(),
    }
}

/// The system of the accelerations of `--force`, from `--q` (default: 1) and `--v` (default: 0).
fn by_forces(options: &SystemArgs) -> Result<EquationSystem, Failure> {
    let count = options.force.len();
    let start = |flag, given: Option<&Coordinates>, default: f64| match given {
        Some(given) if given.values().len() != count => Err(Failure::usage(format!(
            "{flag} `{given}` has {} numbers for {count} of --force; expected equal numbers",
            given.values().len()
        ))),
        Some(given) => Ok(given.values().to_vec()),
        None => Ok(vec![default; count]),
    };
    let q = start("--q", options.q.as_ref(), 1.0)?;
    let v = start("--v", options.v.as_ref(), 0.0)?;
    // A TOML string is quoted as a JSON string is.
    let quoted = |text: &str| serde_json::Value::from(text).to_string();
    let all = |line: &dyn Fn(usize) -> String| -> String { (0..count).map(line).collect() };
    let names: Vec<String> = (0..count).map(|i| quoted(&format!("q{i}"))).collect();
    let text = format!(
        "[system]\nname = \"force\"\ncoordinates = [{}]\n[system.acceleration]\n{}[system.let]\n{}[system.start]\n{}[system.parameters]\n{}",
        names.join(", "),
        all(&|i| format!("q{i} = {}\n", quoted(&options.force[i]))),
        all(&|i| format!("v{i} = \"q{i}'\"\n")),
        all(&|i| format!("q{i} = {:?}\n\"q{i}'\" = {:?}\n", q[i], v[i])),
        options
            .set
            .iter()
            .map(|(name, x)| format!("{} = {x:?}\n", quoted(name)))
            .collect::<String>(),
    );
    EquationSystem::parse(&text, "--force", &[])
        .map_err(|error| Failure::Shown(error.render_styled()))
}
