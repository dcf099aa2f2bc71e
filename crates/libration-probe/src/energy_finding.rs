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
pub(crate) fn energy_leak(defects: Option<&Defects>, modes: &[ProbedMode]) -> Option<String> {
    let drift = defects.and_then(|defects| defects.energy.as_ref());
    if let Some(drift) = drift.filter(|drift| drift.reason == DriftReason::System) {
        return Some(format!(
            "the energy changes by {} per second, whatever the step: the system is not conservative",
            signed(drift.rate)
        ));
    }
    let (mode, flow) = modes.iter().find_map(|mode| {
        let flow = mode.flow?;
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
