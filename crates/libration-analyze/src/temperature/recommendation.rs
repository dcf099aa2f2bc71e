//! The thermostat with the least bias of positions.

use libration_report::verdict::{Outcome, Verdict};

use super::{TemperatureBias, ThermostatReport, significant};

/// Biases below this count as none.
const ROUNDING: f64 = 1e-12;

/// Standard errors within which a measurement may be off.
const ERRORS: f64 = 4.0;

/// The predicted size of a bias; without one infinite.
fn predicted(temperature: &TemperatureBias) -> f64 {
    let size = temperature.fastest_mode_bias.map_or(f64::INFINITY, f64::abs);
    if size < ROUNDING { 0.0 } else { size }
}

/// The least and the largest size of a bias that prediction and measurement allow.
fn range(temperature: &TemperatureBias) -> [f64; 2] {
    let measured = temperature.measured_bias.map_or(0.0, f64::abs);
    let off = ERRORS * temperature.standard_error.unwrap_or(0.0);
    let predicted = predicted(temperature);
    [predicted.max(measured - off), predicted.max(measured) + off]
}

/// The name of the thermostat with the least bias of positions: of those that measurements do not exclude the one with the least
/// prediction, then with the fewest force evaluations, then with the least bias of velocities.
pub(super) fn recommended(thermostats: &[ThermostatReport]) -> Option<String> {
    let is_measured = thermostats.iter().any(|one| one.configuration.measured_bias.is_some());
    let fits = |one: &&ThermostatReport| {
        one.stable
            && one.infinite == 0
            && (!is_measured || one.configuration.measured_bias.is_some())
    };
    let candidates: Vec<&ThermostatReport> = thermostats.iter().filter(fits).collect();
    let least =
        candidates.iter().map(|one| range(&one.configuration)[1]).fold(f64::INFINITY, f64::min);
    let best = candidates.into_iter().filter(|one| range(&one.configuration)[0] <= least);
    let best = best.min_by(|a, b| {
        let of_positions = predicted(&a.configuration).total_cmp(&predicted(&b.configuration));
        let of_velocities = range(&a.kinetic)[0].total_cmp(&range(&b.kinetic)[0]);
        of_positions.then(a.evaluations.cmp(&b.evaluations)).then(of_velocities)
    });
    best.map(|one| one.thermostat.clone())
}

/// Whether the recommended method is stable in steps of `dt` seconds.
pub(super) fn judge(thermostats: &[ThermostatReport], dt: f64) -> Verdict {
    let best = recommended(thermostats);
    let best = thermostats.iter().find(|one| Some(&one.thermostat) == best.as_ref());
    let left_out: Vec<String> = thermostats
        .iter()
        .filter(|one| one.stable && one.configuration.measured_bias.is_none())
        .map(|one| format!("a measurement of {}", one.thermostat))
        .collect();
    let verdict = match best {
        Some(one) => Verdict::new(
            Outcome::Stable,
            format!(
                "all modes with {} are stable up to steps of {} s",
                one.thermostat,
                significant(one.stable_dt)
            ),
        ),
        None if thermostats.iter().any(|one| one.stable) => {
            Verdict::unknown("measured trajectories of each stable method became infinite")
        }
        None => Verdict::new(
            Outcome::Unstable,
            format!("no method is stable in steps of {} s", significant(dt)),
        ),
    };
    left_out.into_iter().fold(verdict, Verdict::without)
}
