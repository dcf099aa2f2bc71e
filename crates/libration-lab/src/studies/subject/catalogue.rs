//! The systems of the catalogue as they are studied.

use libration::{AnySystem, CatalogError, State, with_system};

use super::{Problem, Subject};
use crate::Config;

/// The systems that can be studied by name: those of the catalogue that conserve energy.
pub const SYSTEMS: [&str; 5] = ["oscillator", "pendulum", "duffing", "henon-heiles", "kepler"];

/// The named systems: the oscillator as it is configured, the others with the parameters and the
/// start of the catalogue.
pub(crate) fn configured(
    config: &Config,
    names: &[String],
) -> Result<Vec<Box<dyn Subject>>, CatalogError> {
    names.iter().map(|name| subject(config, name)).collect()
}

fn subject(config: &Config, name: &str) -> Result<Box<dyn Subject>, CatalogError> {
    let system = match name {
        "oscillator" => AnySystem::Oscillator(config.oscillator.system()),
        name => AnySystem::build(name, &[] as &[(&str, f64)])?,
    };
    let entry = system.entry();
    let dimension = *entry.dimensions.start();
    let (title, turn) = looks(system);
    with_system!(
        system,
        dimension,
        |model, D| {
            let start = match system {
                AnySystem::Oscillator(_) => {
                    Some(State { q: [config.start.q; D], v: [config.start.v; D] })
                }
                _ => entry.start::<D>(),
            };
            let start = start.ok_or_else(|| entry.wrong_dimension(D))?;
            let problem = Problem::new(name, model, start, turn).titled(title);
            let subject: Box<dyn Subject> = match rests_at_origin(system) {
                true => Box::new(problem.about(State::origin())),
                false => Box::new(problem),
            };
            Ok(subject)
        },
        Err(entry.wrong_dimension(dimension))
    )
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
