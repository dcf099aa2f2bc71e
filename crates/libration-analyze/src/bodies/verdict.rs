//! The verdict on a motion of bodies.

use libration_report::notation::number;
use libration_report::verdict::{Outcome, Verdict};

use super::approach::ENCOUNTERS_AT_EACH_STEP;
use super::encounter::Encounter;
use super::energies::{BROKEN, PartEnergy};
use super::hidden_change::hidden_change;
use super::{BodiesAudit, BodiesRequest};

/// Steps of an orbit below which an encounter is too fast for the time step.
pub const FEW_STEPS: f64 = 20.0;

/// The same of an oscillation in a pair potential, whose kicks no pericentre makes shorter: its phase is then within two hundredths.
pub const FEW_OSCILLATION_STEPS: f64 = 10.0;

/// The part of the mean mass below which the energies of other bodies hide that of a body.
const LIGHT: f64 = 0.01;

/// The evidence of a verdict besides the audit.
pub(super) struct Evidence<'a> {
    pub(super) request: &'a BodiesRequest,
    /// The pair with the fewest steps per orbit at the start.
    pub(super) shortest: Option<Encounter>,
    /// Two bodies that were nearer than their radii within a step.
    pub(super) pass: Option<Encounter>,
    /// The largest kinetic energy relative to the centre of mass.
    pub(super) largest_kinetic: f64,
    /// Whether the motion exchanges hardly any energy.
    pub(super) is_steady: bool,
    /// The energy that the motion exchanges.
    pub(super) exchanged: f64,
    /// The energy that rounding hides.
    pub(super) rounding: f64,
}

impl BodiesAudit {
    /// The verdict. That energies are kept does not say that the bodies are where they should be.
    pub(super) fn judge(&self, evidence: &Evidence<'_>) -> Verdict {
        if let Some(reason) = &self.stopped {
            return Verdict::new(Outcome::Fault, reason.clone());
        }
        let energy = self.conserved.iter().find(|one| one.quantity == "energy");
        let (change, size) = energy.map_or((f64::NAN, 1.0), |one| (one.largest_change, one.size));
        let what = match self.pair_potential {
            Some(_) => "what the motion exchanges",
            None => "its size",
        };
        let said = format!("the energy changes by {} of {what}", number(change, 3));
        if self.pair_potential.is_some() && evidence.rounding > BROKEN * evidence.exchanged {
            return Verdict::unknown(format!(
                "the motion exchanges an energy of {}, and those of its states are rounded by up to {}",
                number(evidence.exchanged, 2),
                number(evidence.rounding, 2)
            ));
        }
        // A steady motion in a pair potential that loses energy exchanges this loss alone.
        let is_certain =
            self.pair_potential.is_none() || change * size > BROKEN * evidence.largest_kinetic;
        if change.is_nan() || (change > BROKEN && is_certain) {
            return Verdict::new(Outcome::Fault, said);
        }
        let few = self.few_steps(evidence);
        let is_lost = |part: &PartEnergy| part.is_lost && (few.is_none() || part.is_alone);
        if let Some(part) = self.largest_part(is_lost) {
            return Verdict::new(Outcome::Fault, said_of(part));
        }
        match self.doubt(evidence, few, change) {
            Some(reason) => Verdict::unknown(format!("{reason}; {said}")),
            None => self.good(evidence, said),
        }
    }

    /// Why the evidence does not decide, if so.
    fn doubt(&self, evidence: &Evidence<'_>, few: Option<String>, change: f64) -> Option<String> {
        if let Some(pass) = &evidence.pass {
            let [a, b] = &pass.bodies;
            return Some(format!(
                "{a} and {b} pass at a distance of {} at t = {}, below the sum of their radii, between two steps",
                number(pass.distance, 3),
                number(pass.t, 4)
            ));
        }
        if few.is_some() {
            return few;
        }
        if change > BROKEN {
            return Some("a steady motion may lose as much of its energy".to_owned());
        }
        if let Some(part) = self.largest_part(PartEnergy::is_in_doubt) {
            return Some(format!(
                "{}, which is known to {} of it",
                said_of(part),
                number(part.work_error, 2)
            ));
        }
        if let Some(light) = self.light(evidence.request, change) {
            let said = "is too small a part of the energy to be seen in it";
            return Some(format!("the energy of {light} {said}"));
        }
        self.hidden(evidence, change)
    }

    /// An orbit, or a single body, whose energy may have changed by as much as that of all. None where each is looked at.
    fn hidden(&self, evidence: &Evidence<'_>, change: f64) -> Option<String> {
        let energy =
            self.conserved.first().filter(|_| self.energies.is_empty() && self.bodies > 1)?;
        let change = change.max(energy.predicted_by_rounding);
        hidden_change(evidence.request, [change, energy.size], evidence.largest_kinetic)
    }

    /// An orbit or oscillation with few steps.
    fn few_steps(&self, evidence: &Evidence<'_>) -> Option<String> {
        let (few, what) = match self.pair_potential {
            Some(_) => (FEW_OSCILLATION_STEPS, "oscillation"),
            None => (FEW_STEPS, "orbit"),
        };
        let of_few = |own: &&Encounter| own.steps_per_orbit.is_some_and(|steps| steps < few);
        let own = self.encounter.iter().chain(&evidence.shortest).find(of_few)?;
        let [a, b] = &own.bodies;
        Some(format!(
            "an {what} at the distance of {a} and {b} at t = {} has {} steps, fewer than {few}",
            number(own.t, 4),
            number(own.steps_per_orbit.unwrap_or_default(), 2)
        ))
    }

    /// A body whose mass is far below the mean and whose energy may have changed by as much as that of all. None where each is looked at.
    fn light<'a>(&self, request: &'a BodiesRequest, change: f64) -> Option<&'a str> {
        let masses = request.system.bodies.masses();
        if !self.energies.is_empty() {
            return None;
        }
        let total: f64 = masses.iter().sum();
        let rounding = self.conserved.first().map_or(0.0, |one| one.predicted_by_rounding);
        let hidden = |mass: f64| {
            let share = mass / total;
            share * (masses.len() as f64) < LIGHT && BROKEN * share <= change.max(rounding)
        };
        let i = masses.iter().position(|&mass| total > 0.0 && hidden(mass))?;
        Some(&request.system.names[i])
    }

    fn largest_part(&self, of: impl Fn(&PartEnergy) -> bool) -> Option<&PartEnergy> {
        let parts = self.energies.iter().filter(|part| of(part));
        parts.max_by(|a, b| a.most().total_cmp(&b.most()))
    }

    fn good(&self, evidence: &Evidence<'_>, said: String) -> Verdict {
        let said = match self.largest_part(|_| true) {
            Some(part) => {
                let change = number(part.most(), 3);
                format!("{said}, that of {} by at most {change}", part.text())
            }
            None => said,
        };
        let mut verdict = Verdict::new(Outcome::NoFault, said).without("errors of positions");
        if self.pair_potential.is_some() && evidence.is_steady {
            verdict = verdict.without("oscillations with a thousandth of the kinetic energy");
        }
        if self.energies.is_empty() && self.bodies > 1 {
            verdict = verdict.without("energies of single bodies");
        }
        if self.bodies <= ENCOUNTERS_AT_EACH_STEP {
            return verdict;
        }
        verdict = verdict.without("encounters between samples");
        match evidence.request.system.bodies.radii().iter().any(|&radius| radius > 0.0) {
            true => verdict.without("collisions between steps"),
            false => verdict,
        }
    }
}

fn said_of(part: &PartEnergy) -> String {
    let change = number(part.largest_change, 3);
    format!(
        "the energy of {} changes by {change} of its size besides the work of others",
        part.text()
    )
}
