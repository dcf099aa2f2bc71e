//! Units of coordinates, commands and gains.

use libration::AnySystem;
use libration::catalog::Actuation;

/// Units of a system's coordinates, of its commands, and of the gains of controllers; empty where none are known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Units {
    /// Unit of time.
    pub time: &'static str,
    /// Unit of positions.
    pub position: &'static str,
    /// Unit of velocities.
    pub velocity: &'static str,
    /// Unit of the energy per unit mass.
    pub energy: &'static str,
    /// Unit of commands.
    pub command: &'static str,
    /// Units of the gains of position, velocity and the integral of the position.
    pub gains: [&'static str; 3],
}

/// The units of `system` with commands of the kind `actuation`.
pub fn of(system: AnySystem, actuation: Actuation) -> Units {
    let (position, velocity, energy, acceleration) = match system {
        AnySystem::Oscillator(_)
        | AnySystem::DampedOscillator(_)
        | AnySystem::DrivenOscillator(_)
        | AnySystem::Duffing(_)
        | AnySystem::Kepler(_) => ("m", "m/s", "J/kg", "m/s²"),
        AnySystem::Pendulum(_) => ("rad", "rad/s", "rad^2 s^-2", "rad/s²"),
        AnySystem::HenonHeiles(_) => ("1", "1", "1", "1"),
    };
    let time = if matches!(system, AnySystem::HenonHeiles(_)) { "1" } else { "s" };
    let (command, gains) = match actuation {
        Actuation::Force { .. } => ("N", ["N/m", "N·s/m", "N/(m·s)"]),
        Actuation::Acceleration if time == "1" => ("1", ["1"; 3]),
        Actuation::Acceleration => (acceleration, ["s⁻²", "s⁻¹", "s⁻³"]),
    };
    Units { time, position, velocity, energy, command, gains }
}
