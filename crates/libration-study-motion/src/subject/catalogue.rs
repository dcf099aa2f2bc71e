//! Systems of the catalogue as subjects of studies.

use libration::{AnySystem, CatalogError, Model, State};
use libration_study::Config;

use super::Problem;

/// The systems that can be studied by name: those of the catalogue that conserve energy.
pub const SYSTEMS: [&str; 5] = ["oscillator", "pendulum", "duffing", "henon-heiles", "kepler"];

/// The named systems: the oscillator as it is configured, the others with the parameters and the
/// start of the catalogue.
pub(crate) fn configured(config: &Config, names: &[String]) -> Result<Vec<Problem>, CatalogError> {
    names.iter().map(|name| subject(config, name)).collect()
}

fn subject(config: &Config, name: &str) -> Result<Problem, CatalogError> {
    let system = match name {
        "oscillator" => AnySystem::Oscillator(config.oscillator.system()),
        name => AnySystem::build(name, &[] as &[(&str, f64)])?,
    };
    // Each in its smallest dimension.
    match system {
        AnySystem::Oscillator(model) => {
            let start = State { q: [config.start.q], v: [config.start.v] };
            Ok(problem(system, model, start))
        }
        AnySystem::Pendulum(model) => catalogued::<1>(system, model),
        AnySystem::Duffing(model) => catalogued::<1>(system, model),
        AnySystem::HenonHeiles(model) => catalogued::<2>(system, model),
        AnySystem::Kepler(model) => catalogued::<2>(system, model),
        AnySystem::DampedOscillator(_) | AnySystem::DrivenOscillator(_) => {
            Err(CatalogError::UnknownSystem { name: name.to_owned() })
        }
    }
}

/// With the start of the catalogue.
fn catalogued<const D: usize>(
    system: AnySystem,
    model: impl Model<D>,
) -> Result<Problem, CatalogError> {
    let entry = system.entry();
    let start = entry.start::<D>().ok_or_else(|| entry.wrong_dimension(D))?;
    Ok(problem(system, model, start))
}

fn problem<const D: usize>(
    system: AnySystem,
    model: impl Model<D>,
    start: State<f64, D>,
) -> Problem {
    let (title, turn) = looks(system);
    let problem = Problem::new(system.name(), model, start, turn).titled(title);
    match rests_at_origin(system) {
        true => problem.with_equilibrium(State::<f64, D>::origin()),
        false => problem,
    }
}

/// Name in running text, and about the time of a turn.
fn looks(system: AnySystem) -> (&'static str, f64) {
    // A frequency of zero, which the catalogue admits for some, has no turn: one second then.
    let turn = |omega2: f64| match omega2.abs().sqrt() {
        0.0 => 1.0,
        omega => std::f64::consts::TAU / omega,
    };
    match system {
        AnySystem::Oscillator(s) => ("oscillator", turn(s.omega2)),
        AnySystem::DampedOscillator(s) => ("damped oscillator", turn(s.omega2)),
        AnySystem::DrivenOscillator(s) => ("driven oscillator", turn(s.omega2)),
        AnySystem::Pendulum(s) => ("pendulum", turn(s.omega2)),
        AnySystem::Duffing(s) => ("Duffing oscillator", turn(2.0 * s.alpha)),
        AnySystem::Kepler(s) => ("Kepler, e = 0.6", turn(s.mu)),
        AnySystem::HenonHeiles(_) => ("Hénon–Heiles", turn(1.0)),
    }
}

/// Whether the origin is a stable equilibrium.
fn rests_at_origin(system: AnySystem) -> bool {
    match system {
        AnySystem::Oscillator(_) | AnySystem::Pendulum(_) | AnySystem::HenonHeiles(_) => true,
        AnySystem::Duffing(s) => s.alpha > 0.0,
        _ => false,
    }
}
