//! Evidence that the energy of a system is not conserved.

use libration_report::notation::{number, plural};

use crate::{Defects, DriftReason, DrivenVelocity, EnergyDrift, ProbeReport, ProbedMode};

/// Rates of a conservative system relative to its frequencies that are no roundings.
const LEAK: f64 = 1e-9;

/// Steps over which the energy of a mode counts, and the part of it that the step may take in them: as in a run with the energy.
const MODE_STEPS: f64 = 20_000.0;
const MODE_LOSS: f64 = 0.01;

/// An energy that changes too much in one direction, in words.
pub(crate) fn energy_drift(drift: &EnergyDrift, is_conservative: bool, dt: f64) -> Option<String> {
    if !drift.is_fault(is_conservative) {
        return None;
    }
    let time = number(drift.steps as f64 * dt, 4);
    let Some(change) = drift.change else {
        return Some(format!(
            "the energy diverges: the run of the audit leaves the finite numbers after {time} s, and with an eighth of the step it does not so soon"
        ));
    };
    let verb = if change > 0.0 { "grows" } else { "falls" };
    let reason = match drift.is_of_step {
        Some(true) => "it does not grow so with an eighth of the step",
        _ => drift.reason.text(),
    };
    Some(format!(
        "the energy {verb} by {} % over {} ({time} s){}; {reason}",
        number(100.0 * change.abs(), 3),
        plural(drift.steps, "step"),
        if drift.is_steady { ", in one direction" } else { "" }
    ))
}

/// A mode whose energy the step alone takes, of a conservative system without a known energy, in words.
pub(crate) fn mode_loss(report: &ProbeReport) -> Option<String> {
    if report.defects.as_ref().is_some_and(|defects| defects.energy.is_some()) {
        return None;
    }
    let lost = |mode: &ProbedMode| {
        let flow = mode.flow.filter(|flow| flow.frequency > 0.0)?;
        let added = mode.step.growth_rate - flow.growth_rate;
        let loss = -(2.0 * added * report.dt * MODE_STEPS).exp_m1();
        (loss > MODE_LOSS && -added > 10.0 * mode.error).then_some(loss)
    };
    let (mode, loss) = report.modes.iter().find_map(|mode| Some((mode, lost(mode)?)))?;
    Some(format!(
        "the step takes {} % of the energy of the mode of {} in {} steps, and the system takes none",
        number(100.0 * loss, 3),
        mode.names(),
        MODE_STEPS
    ))
}

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
