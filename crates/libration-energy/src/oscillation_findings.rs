//! The findings about the oscillation.

use libration_report::notation::number;

use crate::FindingKind as Kind;
use crate::convergence::Convergence;
use crate::interval::{exponent, interval};
use crate::{EnergyReport, Finding, OscillationCause, Run};

/// Exponents below this are of first order.
const FIRST_ORDER: f64 = 1.5;

/// That the oscillation does not fall with the step. It is a fault only of runs that stay together the longer, the shorter their steps:
/// errors that saturate, and random forces, have as large a size at each step.
pub(crate) fn step_independent(
    report: &EnergyReport,
    convergence: &Convergence,
) -> Option<Finding> {
    if report.oscillation_cause != OscillationCause::StepIndependent {
        return None;
    }
    let (first, last) = (report.runs.first()?, report.runs.last()?);
    let (kind, why) = match convergence.stays_together {
        true => {
            (Kind::StepIndependentOscillation, "it is not the energy that the simulation conserves")
        }
        false => (
            Kind::NotConverged,
            "the runs do not converge, as those of shorter steps do not stay together for longer: the steps do not resolve the motion, or forces are random",
        ),
    };
    Some(Finding::new(
        kind,
        format!(
            "the energy fluctuates by {} at dt = {} s and by {} at dt = {} s (standard deviations): {why}",
            interval(first.oscillation, 3),
            number(first.dt, 4),
            interval(last.oscillation, 3),
            number(last.dt, 4),
        ),
    ))
}

/// That the oscillation has order 1.
pub(crate) fn first_order(report: &EnergyReport) -> Option<Finding> {
    let law = report.oscillation_law.filter(|law| law.exponent.high < FIRST_ORDER)?;
    (report.oscillation_cause == OscillationCause::Truncation).then(|| {
        Finding::new(
            Kind::FirstOrderOscillation,
            format!(
                "the energy oscillates with order {}, as of symplectic Euler, or of velocities half a step off",
                exponent(law.exponent)
            ),
        )
    })
}

/// That the runs do not tell how the oscillation depends on the step, or that a run has no interval of it.
pub(crate) fn unclear(report: &EnergyReport) -> Option<Finding> {
    no_interval(report).or_else(|| no_law(report))
}

fn no_law(report: &EnergyReport) -> Option<Finding> {
    if report.oscillation_cause != OscillationCause::Unclear {
        return None;
    }
    let (first, last) = (report.runs.first()?, report.runs.last()?);
    let law = report
        .oscillation_law
        .map_or_else(String::new, |law| format!(", proportional to dt^{}", exponent(law.exponent)));
    Some(Finding::new(
        Kind::UnclearOscillation,
        format!(
            "the energy fluctuates by {} at dt = {} s and by {} at dt = {} s (standard deviations){law}: the runs do not tell whether it falls with the step",
            interval(first.oscillation, 3),
            number(first.dt, 4),
            interval(last.oscillation, 3),
            number(last.dt, 4),
        ),
    ))
}

fn no_interval(report: &EnergyReport) -> Option<Finding> {
    // What is below the digits of the energies is no oscillation.
    let is_unclear = |run: &&Run| run.has_unclear_oscillation() && run.resolves_oscillation();
    let run = report.runs.iter().find(is_unclear)?;
    Some(Finding::new(
        Kind::UnclearOscillation,
        format!(
            "the energy of `{}` fluctuates by about {} with a memory that is no small part of the {} s of the run: the size has no interval",
            run.title,
            number(run.oscillation.value, 2),
            number(run.duration, 4)
        ),
    ))
}
