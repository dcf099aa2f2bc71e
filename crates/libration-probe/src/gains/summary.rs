//! The verdict on gains and the answer, in sentences.

use libration_report::notation::{cut_off, number};
use libration_report::verdict::{Outcome, Verdict};

use super::report::MOST_SUBSTEPS;
use super::{GainReport, ServoIntegrator, Torque};

/// Growth per step beside which five digits of a spectral radius show nothing.
const SMALL: f64 = 1e-4;

/// What the servo model does not have.
const NOT_MODELLED: &str = "contacts, constraints, friction and limits of forces";

impl GainReport {
    pub(super) fn verdict_of_model(&self) -> Verdict {
        let radius = beside_one(self.spectral_radius_minus_one, 6);
        let verdict = match self.growth_in_continuous_time {
            Some(growth) => Verdict::new(
                Outcome::Unstable,
                format!("the motion grows at {} 1/s in continuous time", number(growth, 5)),
            ),
            None if !self.is_known => Verdict::unknown(format!(
                "rounding may hide growth of the servo model: spectral radius {radius}"
            )),
            None if self.holds_in_model => Verdict::new(
                Outcome::Stable,
                format!("spectral radius {radius} of the servo model"),
            ),
            None => Verdict::new(
                Outcome::Unstable,
                match self.is_at_limit {
                    true => format!("the servo model is at its limit: spectral radius {radius}"),
                    false => format!("spectral radius {radius} of the servo model"),
                },
            ),
        };
        verdict.without(NOT_MODELLED)
    }

    /// The steps in words.
    pub(super) fn steps(&self) -> String {
        let h = self.dt / f64::from(self.substeps);
        let torque = match (self.substeps, self.torque) {
            (1, Torque::EachSubstep) => String::new(),
            (_, torque) => format!(", {}", torque.in_words()),
        };
        match self.substeps {
            1 => format!("steps of {} s{torque}", number(h, 6)),
            substeps => format!("{substeps} substeps of {} s{torque}", number(h, 4)),
        }
    }

    /// The range of factors that hold, where the given gains are unstable in continuous time; empty without one.
    pub(super) fn window(&self) -> String {
        let least = number(self.least_factor * (1.0 + 5e-6), 5);
        match (self.least_factor, self.largest_factor) {
            (0.0, _) => String::new(),
            (_, f64::INFINITY) => {
                format!(
                    " With this step gains of position hold from {least} times the given ones on."
                )
            }
            (_, most) => format!(
                " With {} and this step gains of position hold from {least} to {} times the given ones.",
                ServoIntegrator::label(self.integrator),
                number(cut_off(most, 5), 5)
            ),
        }
    }

    /// The largest common factor of gains of position, as the end of a sentence.
    pub(super) fn factor(&self) -> String {
        match self.largest_factor {
            _ if self.is_at_limit && self.measured.is_none() => ".".to_owned(),
            x if x.is_nan() => ".".to_owned(),
            f64::INFINITY if self.holds && self.has_kp && !self.has_negative_kp() => {
                "; no larger gain of position was found that does not hold.".to_owned()
            }
            f64::INFINITY => ".".to_owned(),
            0.0 => "; no tried factor of all gains of position makes them hold.".to_owned(),
            factor => {
                // At the limit itself they do not hold.
                let factor = number(cut_off(factor * (1.0 - 1e-11), 5), 5);
                format!("; the largest gains of position are {factor} times the given ones.")
            }
        }
    }

    fn has_negative_kp(&self) -> bool {
        self.measured.as_ref().is_some_and(|measured| measured.negative_gain.is_some())
    }

    pub(super) fn summary(&self) -> String {
        if self.is_withheld {
            return format!("Whether the gains hold is unknown: {}.", self.verdict.evidence);
        }
        let integrator = ServoIntegrator::label(self.integrator);
        let of = self.steps();
        let limits = format!("This servo model has no {NOT_MODELLED}.");
        let limits =
            format!("{limits} A gain that holds in free motion may be unstable in contact.");
        if let Some(growth) = self.growth_in_continuous_time {
            return format!(
                "The motion is unstable in continuous time, whatever the step: it grows by {} 1/s with these gains and stiffnesses.{} {limits}",
                number(growth, 5),
                self.window()
            );
        }
        if self.unstable_without_servos {
            let stiffest = self.modes.first().map_or_else(String::new, |mode| {
                mode.joints.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>().join(", ")
            });
            return format!(
                "The step is unstable without any servo: springs or damping of the joints alone make a mode grow in {of} with {integrator}. With the servos the fastest mode is that of {stiffest}, and the largest factor of a mode is {} per step.{} {limits}",
                beside_one(self.spectral_radius_minus_one, 5),
                self.substeps_in_words()
            );
        }
        if !self.is_known {
            return format!(
                "Whether the gains hold with {integrator} and {of} is unknown: rounding may hide growth of a mode.{} {limits}",
                self.others_in_words()
            );
        }
        let mut text = if self.holds {
            format!("The gains hold with {integrator} and {of}")
        } else if self.is_at_limit {
            format!(
                "The gains do not hold with {integrator} and {of}: they are at the limit of stability, where a motion does not decay or grows with the number of steps"
            )
        } else {
            format!(
                "The gains do not hold with {integrator} and {of}: a mode grows by a factor {} per step",
                beside_one(self.spectral_radius_minus_one, 5)
            )
        };
        text += &self.factor();
        text += &self.tightest();
        if !self.holds {
            text += &self.substeps_in_words();
            text += &self.others_in_words();
        }
        format!("{text} {limits}")
    }

    /// The integrators with which the gains hold, as a sentence.
    fn others_in_words(&self) -> String {
        let others = self.integrators.iter().filter(|row| row.holds);
        let others: Vec<String> = others.map(|row| ServoIntegrator::label(row.name)).collect();
        match others.is_empty() {
            true => String::new(),
            false => format!(" They hold with {}.", others.join(", ")),
        }
    }

    /// The gains with the least margin, in sentences.
    fn tightest(&self) -> String {
        let limited = |largest: f64, given: f64| largest.is_finite() && given > 0.0;
        let mut text = String::new();
        let of_kp = self.joints.iter().filter(|joint| limited(joint.largest_kp, joint.kp));
        let of_kp = of_kp.min_by(|a, b| (a.largest_kp / a.kp).total_cmp(&(b.largest_kp / b.kp)));
        if let Some(joint) = of_kp {
            let most = match joint.largest_kp {
                0.0 => "no tried gain of it holds".to_owned(),
                most => format!("its gain must stay below {}", number(cut_off(most, 5), 5)),
            };
            text += &format!(
                " The joint with the least margin is {}: {most}, with all others as they are.",
                joint.name
            );
        }
        let of_kv = self.joints.iter().filter(|joint| limited(joint.largest_kv, joint.kv));
        let of_kv = of_kv.filter(|joint| joint.largest_kv > 0.0);
        let of_kv = of_kv.min_by(|a, b| (a.largest_kv / a.kv).total_cmp(&(b.largest_kv / b.kv)));
        if let Some(joint) = of_kv {
            text += &format!(
                " The gain of velocity of {} must stay below {}; given {}.",
                joint.name,
                number(cut_off(joint.largest_kv, 5), 5),
                number(joint.kv, 5)
            );
        }
        text
    }

    /// The fewest substeps, as a sentence.
    pub(super) fn substeps_in_words(&self) -> String {
        match self.fewest_substeps {
            Some(1) => " One substep holds them.".to_owned(),
            Some(substeps) => format!(" {substeps} substeps hold them."),
            None => format!(" No number of substeps up to {MOST_SUBSTEPS} holds them."),
        }
    }
}

/// A spectral radius from its difference from 1, with the digits of a small one: `1 + 5·10⁻⁸`.
fn beside_one(excess: f64, digits: usize) -> String {
    match excess {
        excess if excess == 0.0 || excess.abs() >= SMALL => number(1.0 + excess, digits),
        excess if excess > 0.0 => format!("1 + {}", number(excess, 3)),
        excess => format!("1 − {}", number(-excess, 3)),
    }
}
