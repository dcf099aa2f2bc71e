//! A motion beside the exact one.

use libration_analyze::motion::{EnergyChange, MotionExamination};
use libration_report::verdict::{Outcome, Verdict};

use super::super::digits::significant;

/// Whether steps resolve a motion, in a sentence about `step`, with the number of examined steps.
pub(super) fn sentence(
    step: &str,
    verdict: &Verdict,
    motion: &MotionExamination,
    dt: f64,
) -> String {
    if let (Some(step_number), None) = (motion.diverged_at_step, &motion.undefined) {
        return format!("{step} diverges: a state is not finite after step {step_number}.");
    }
    let evidence = &verdict.evidence;
    let time = |steps: u64| significant(steps as f64 * dt, 6);
    let (examined, requested) = (motion.examined_steps, motion.requested_steps);
    let over = match examined < requested {
        true => format!("the first {examined} of {requested} steps ({} s)", time(examined)),
        false => format!("{requested} steps ({} s)", time(requested)),
    };
    match verdict.outcome {
        Outcome::Unknown => {
            format!("Whether {step} resolves the motion is not known: {evidence}.")
        }
        outcome if outcome.is_good() => {
            format!("{step} resolves the motion over {over}: {evidence}.")
        }
        _ => format!("{step} does not resolve the motion over {over}: {evidence}."),
    }
}

/// Part of the exchanged energy below which a change is rounding.
const ROUNDING: f64 = 1e-9;

/// The change of the energy, by the steps and by the system.
pub(in crate::commands) fn energy_change(energy: &EnergyChange) -> String {
    let EnergyChange { unit, steps, scale, .. } = energy;
    if !energy.largest.is_finite() {
        return format!("is not finite after step {}", energy.largest_at_step);
    }
    let quantity = |x: f64| format!("{} {unit}", significant(x, 3)).trim_end().to_owned();
    let part = |x: f64| match scale {
        Some(scale) => {
            format!(", {} of the energy that the motion exchanges", significant(x / scale, 3))
        }
        None => String::new(),
    };
    let own = energy.exact_change.filter(|own| *own > ROUNDING * scale.unwrap_or(f64::INFINITY));
    match (own, energy.error) {
        (Some(own), Some(error)) => format!(
            "the system itself changes it by {}; the error of the steps is at most {}{}",
            quantity(own),
            quantity(error),
            part(error)
        ),
        _ => {
            let reduction = energy.reduction.map_or_else(String::new, |reduction| {
                format!("; halved steps reduce this by {}", significant(reduction, 4))
            });
            format!(
                "changes by at most {}{}, over {steps} steps{reduction}",
                quantity(energy.largest),
                part(energy.largest)
            )
        }
    }
}
