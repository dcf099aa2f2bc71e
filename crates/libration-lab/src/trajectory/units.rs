//! Units of a trajectory's columns.

use libration::AnySystem;

/// Units of `step`, `t`, the positions, the velocities and the energy per mass.
pub(super) fn of_columns(system: AnySystem, dimension: usize) -> Vec<&'static str> {
    let (q, v, energy) = match system {
        AnySystem::Oscillator(_)
        | AnySystem::DampedOscillator(_)
        | AnySystem::DrivenOscillator(_)
        | AnySystem::Duffing(_)
        | AnySystem::Kepler(_) => ("m", "m/s", "J/kg"),
        AnySystem::Pendulum(_) => ("rad", "rad/s", "rad^2 s^-2"),
        AnySystem::HenonHeiles(_) => ("1", "1", "1"),
    };
    let t = if matches!(system, AnySystem::HenonHeiles(_)) { "1" } else { "s" };
    let mut units = vec!["1", t];
    units.extend(std::iter::repeat_n(q, dimension));
    units.extend(std::iter::repeat_n(v, dimension));
    units.push(energy);
    if matches!(system, AnySystem::DrivenOscillator(_)) && dimension == 2 {
        // Its second coordinate is time.
        units[3] = "s";
        units[5] = "1";
    }
    units
}
