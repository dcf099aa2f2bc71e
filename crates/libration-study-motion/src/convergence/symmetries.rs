//! The symmetries of velocity Verlet on nonlinear systems.

use libration::Method;
use libration_report::Record;
use libration_report::record::{Finding, Tolerance};
use libration_study::{Lab, StudyError};

use super::ConvergenceSettings;
use crate::subject::{Problem, ROUNDING};

/// Measures them.
pub(super) fn measure(
    lab: &Lab<'_>,
    subjects: &[Problem],
    record: &mut Record,
) -> Result<(), StudyError> {
    let method = Method::VelocityVerlet;
    if !lab.config.integrators.contains(&method) {
        return Ok(());
    }
    let found = lab.sweep("symmetries of Verlet", subjects, |subject| {
        let law = subject.law();
        Ok((!law.linear && !law.velocity_dependent && law.has_potential)
            .then(|| subject.symmetry(method, lab.config.get::<ConvergenceSettings>().coarsest)))
    })?;
    for (subject, symmetry) in subjects.iter().zip(found) {
        let Some(symmetry) = symmetry else { continue };
        for (quantity, what, measured) in [
            ("symplecticity", "‖MᵀJM − J‖", symmetry.symplecticity),
            ("reversibility", "‖M(−Δt)M(Δt) − 1‖", symmetry.reversibility),
        ] {
            record.find(Finding::predicted(
                format!("convergence.{}.{}.{quantity}", subject.name(), method.name()),
                format!(
                    "{}, {}: {what} of the Jacobian of one step, in 1024 bits",
                    method.title(),
                    subject.title()
                ),
                "1",
                0.0,
                measured,
                Tolerance::absolute(ROUNDING, SYMMETRY),
            ));
        }
    }
    Ok(())
}

/// Explanation of the bound on a zero defect.
const SYMMETRY: &str = "2⁻⁹⁰⁰: 1024 bits, less what a step and its products can lose of them";
