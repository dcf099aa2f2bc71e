//! Findings about the energy of a system: negative damping and leaks.

use libration_report::notation::number;

use crate::{Finding, ProbeReport};

/// Rates of a conservative system relative to its frequencies that are no roundings.
const LEAK: f64 = 1e-9;

/// Velocities that drive themselves. A step cannot tell whether its author wants that, unless the system conserves energy.
pub(crate) fn damping(report: &ProbeReport, found: &mut Vec<Finding>) {
    for driven in &report.driven_velocities {
        let text = format!(
            "`{}` accelerates itself by {} 1/s: its damping has the wrong sign, unless the system is meant to be driven",
            driven.state,
            number(driven.rate, 5)
        );
        found.push(Finding::new("negative-damping", report.is_conservative, text));
    }
}

/// Energy that a conservative system gains or loses.
pub(crate) fn leaks(report: &ProbeReport, found: &mut Vec<Finding>) {
    if !report.is_conservative {
        return;
    }
    use crate::DriftReason::System;
    let drift = report.defects.as_ref().and_then(|defects| defects.energy.as_ref());
    if let Some(drift) = drift.filter(|drift| drift.reason == System) {
        found.push(Finding::fault(
            "energy-leak",
            format!(
                "the energy changes by {} per second, whatever the step: the system is not conservative",
                signed(drift.rate)
            ),
        ));
        return;
    }
    let leak = report.modes.iter().find_map(|mode| {
        let flow = mode.flow?;
        let size = core::f64::consts::TAU * flow.frequency;
        (flow.frequency > 0.0 && flow.growth_rate.abs() > (LEAK * size).max(3.0 * mode.error))
            .then_some((mode, flow))
    });
    if let Some((mode, flow)) = leak {
        let names: Vec<&str> = mode.states.iter().map(|(name, _)| name.as_str()).collect();
        found.push(Finding::fault(
            "energy-leak",
            format!(
                "the energy of the mode of {} changes by {} per second in the limit of small steps: the system is not conservative",
                names.join(", "),
                signed(2.0 * flow.growth_rate)
            ),
        ));
    }
}

/// A relative rate with its sign.
fn signed(rate: f64) -> String {
    format!("{}{} of itself", if rate > 0.0 { "+" } else { "" }, number(rate, 4))
}
