//! Evidence that the energy of a system is not conserved.

use libration_report::notation::number;

use crate::{Defects, DriftReason, DrivenVelocity, ProbedMode};

/// Rates of a conservative system relative to its frequencies that are no roundings.
const LEAK: f64 = 1e-9;

/// A velocity that drives itself, in words.
pub(crate) fn negative_damping(driven: &DrivenVelocity) -> String {
    format!(
        "`{}` accelerates itself by {} 1/s: its damping has the wrong sign, unless the system is meant to be driven",
        driven.state,
        number(driven.rate, 5)
    )
}

/// Energy that the system itself gains or loses, in words.
///
/// Modes show it at an equilibrium only, and not against a trajectory that would have shown it.
pub(crate) fn energy_leak(
    defects: Option<&Defects>,
    modes: &[ProbedMode],
    is_at_rest: bool,
) -> Option<String> {
    let drift = defects.and_then(|defects| defects.energy.as_ref());
    if let Some(drift) = drift.filter(|drift| drift.reason == DriftReason::System) {
        return Some(format!(
            "the energy changes by {} per second, whatever the step: the system is not conservative",
            signed(drift.rate)
        ));
    }
    let unseen =
        drift.filter(|drift| drift.reason == DriftReason::None).map(|drift| drift.resolution);
    let (mode, flow) = modes.iter().filter(|_| is_at_rest).find_map(|mode| {
        let flow = mode.flow?;
        if unseen.is_some_and(|resolution| 2.0 * flow.growth_rate.abs() > 3.0 * resolution) {
            return None;
        }
        let size = core::f64::consts::TAU * flow.frequency;
        (flow.frequency > 0.0 && flow.growth_rate.abs() > (LEAK * size).max(3.0 * mode.error))
            .then_some((mode, flow))
    })?;
    Some(format!(
        "the energy of the mode of {} changes by {} per second in the limit of small steps: the system is not conservative",
        mode.names(),
        signed(2.0 * flow.growth_rate)
    ))
}

/// A relative rate with its sign.
fn signed(rate: f64) -> String {
    format!("{}{} of itself", if rate > 0.0 { "+" } else { "" }, number(rate, 4))
}
