//! The verdict on a motion of bodies.

use libration_report::notation::number;
use libration_report::verdict::{Outcome, Verdict};

use super::{BodiesAudit, Encounter};

/// Steps of an orbit below which an encounter is too fast for the time step.
pub const FEW_STEPS: f64 = 20.0;

/// The part of its size by which the energy changes in a motion that is not that of the bodies: distances change by as much.
const BROKEN: f64 = 0.1;

impl BodiesAudit {
    /// The verdict. That the energy is kept does not say that the bodies are where they should be.
    pub(super) fn judge(&self, shortest: Option<&Encounter>) -> Verdict {
        if let Some(reason) = &self.stopped {
            return Verdict::new(Outcome::Fault, reason.clone());
        }
        let energy = self.conserved.iter().find(|one| one.quantity == "energy");
        let change = energy.map_or(f64::NAN, |one| one.largest_change);
        let evidence = format!("the energy changes by {} of its size", number(change, 3));
        if change.is_nan() || change > BROKEN {
            return Verdict::new(Outcome::Fault, evidence);
        }
        let of_few = |own: &&Encounter| own.steps_per_orbit.is_some_and(|steps| steps < FEW_STEPS);
        if let Some(own) = self.encounter.iter().chain(shortest).find(of_few) {
            let [a, b] = &own.bodies;
            return Verdict::unknown(format!(
                "an orbit at the distance of {a} and {b} at t = {} has {} steps, fewer than {FEW_STEPS}; {evidence}",
                number(own.t, 4),
                number(own.steps_per_orbit.unwrap_or_default(), 2)
            ));
        }
        Verdict::new(Outcome::NoFault, evidence).without("errors of positions")
    }
}
