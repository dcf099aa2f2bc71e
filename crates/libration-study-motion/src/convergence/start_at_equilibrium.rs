//! Symplectic Euler from the equilibrium, where its positions have order two.

use libration::{Method, State};
use libration_report::Record;
use libration_report::record::{Finding, Series};
use libration_study::{Fit, Lab, StudyError};

use super::super::subject::{Kind, Problem};
use super::halvings;

/// Symplectic Euler from the equilibrium of the oscillator, where `a(0) = 0`.
///
/// Its positions are those of a Verlet orbit that begins half a kick later. Without a first kick
/// nothing tells the two apart: position alone shows order two, and velocity does not.
pub(super) fn measure(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let method = Method::SymplecticEuler;
    if !lab.config.integrators.contains(&method) {
        return Ok(());
    }
    let (spring, start) = (lab.config.oscillator, lab.config.start);
    let speed = start.v.hypot(start.q * spring.omega());
    let from = State { q: [0.0], v: [speed] };
    let turn = std::f64::consts::TAU / spring.omega();
    let problem = Problem::new("trap", spring.system(), from, turn);
    let errors = problem.errors(Kind::FromStart, method, halvings(lab))?;
    let parts = [
        ("position", 2.0, &errors.position),
        ("velocity", 1.0, &errors.velocity),
        ("together", 1.0, &errors.together),
    ];
    for (part, order, errors_of) in parts {
        let Some(fit) = Fit::new(&errors.dt, errors_of) else { continue };
        record.find(Finding::predicted(
            format!("convergence.trap.{part}"),
            format!(
                "{}, oscillator from its equilibrium: exponent of Δt in the error of the orbit, {}",
                method.title(),
                match part {
                    "together" => "in position and velocity".into(),
                    part => format!("in {part} alone"),
                }
            ),
            "1",
            order,
            fit.exponent,
            fit.tolerance(),
        ));
    }
    record.series.push(
        Series::new("trap")
            .with("dt", "s", errors.dt)
            .with("position", "m", errors.position)
            .with("velocity", "m/s", errors.velocity)
            .with("together", "m", errors.together),
    );
    Ok(())
}
