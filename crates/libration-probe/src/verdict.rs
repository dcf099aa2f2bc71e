//! The verdict of an audit: the one source of its sentences, its title and its exit code.

use core::f64::consts::TAU;

use libration_report::notation::{number, plural};
use libration_report::verdict::{Outcome, Verdict, follows_growth};

use crate::FindingKind::{GrowsAlways, UnstableStep};
use crate::{Finding, Observed, ProbeReport, Subject};

/// Growth per step that is no rounding.
const GROWTH: f64 = 1e-9;

/// What the fastest mode of the step says of its stability.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Growth {
    /// No mode grows.
    None,
    /// A mode grows, and does so in the system.
    OfSystem,
    /// A mode grows by the step alone, or much faster than in the system.
    OfStep,
    /// A mode grows, and whether it does so in the system is unknown.
    Unknown,
}

impl ProbeReport {
    /// The verdict on what was examined.
    pub(crate) fn judge(&self, subject: &Subject) -> Verdict {
        let faults: Vec<&Finding> =
            self.findings.iter().filter(|finding| finding.is_fault).collect();
        let mut verdict = match faults[..] {
            [only] => Verdict::new(Outcome::Fault, only.text.clone()),
            [first, ..] => Verdict::new(
                Outcome::Fault,
                format!("{}, the first: {}", plural(faults.len(), "fault"), first.text),
            ),
            [] => self.without_fault(),
        };
        verdict.not_examined.extend(subject.not_examined.iter().cloned());
        verdict.not_examined.extend(self.not_examined().into_iter().map(str::to_owned));
        verdict
    }

    fn without_fault(&self) -> Verdict {
        if self.step.is_none() {
            return Verdict::unknown(
                "the step was not linearised: its results near the state are not finite",
            );
        }
        if !self.is_differentiable() {
            return Verdict::unknown("the step has no derivative at this state");
        }
        let is_unstable = |finding: &&Finding| matches!(finding.kind, UnstableStep | GrowsAlways);
        if let Some(finding) = self.findings.iter().find(is_unstable) {
            return Verdict::unknown(finding.text.clone());
        }
        if self.growth() == Growth::Unknown {
            return Verdict::unknown(format!(
                "a mode grows by a factor of {} per step, and whether it grows in the system, too, is unknown",
                number(self.spectral_radius, 6)
            ));
        }
        if let Some(reason) = self.lost_growth() {
            return Verdict::new(Outcome::NotResolved, reason);
        }
        if let Some(reason) = self.uneven_responses.first() {
            return Verdict::unknown(reason.clone());
        }
        let energy = self.defects.as_ref().and_then(|defects| defects.energy.as_ref());
        if self.is_conservative && energy.is_some_and(|energy| energy.is_unexamined()) {
            return Verdict::unknown(
                "whether the energy is conserved: its run leaves the finite numbers with shorter steps, too, or has few periods of the slowest mode",
            );
        }
        let checks = match self.modes.is_empty() {
            true => String::new(),
            false => format!(
                "spectral radius {}, {}",
                number(self.spectral_radius, 7),
                self.unseen_growth()
            ),
        };
        Verdict::new(Outcome::NoFault, checks)
    }

    /// The mode whose growth in the system the step does not follow, in words.
    fn lost_growth(&self) -> Option<String> {
        self.modes.iter().find_map(|mode| {
            let flow = mode.flow?;
            let (own, system) = (mode.step.growth_rate, flow.growth_rate);
            let grows = system > 10.0 * mode.error && system * self.dt > GROWTH;
            let [re, im] = mode.factor;
            // The angle of a turn and that of the turn back are one.
            let turn = (TAU * flow.frequency * self.dt).rem_euclid(TAU);
            let exact = [system * self.dt, turn.min(TAU - turn)];
            let follows = follows_growth([own * self.dt, im.atan2(re).abs()], exact);
            (grows && !follows).then(|| {
                let turns = if im == 0.0 && re < 0.0 { ", with another sign in each" } else { "" };
                format!(
                    "a mode grows at {} 1/s in the system, and at {} 1/s in the step{turns} ({})",
                    number(system, 4),
                    number(own, 4),
                    mode.names()
                )
            })
        })
    }

    /// The growth per step that the audit cannot tell from none, in words.
    pub(crate) fn unseen_growth(&self) -> String {
        let errors = self.modes.iter().map(|mode| 10.0 * mode.error * self.dt * mode.radius);
        let unseen = errors.fold(GROWTH, f64::max);
        format!(
            "growth below {} per step ({} 1/s) is not measurable",
            number(unseen, 2),
            number(unseen / self.dt, 2)
        )
    }

    /// What the fastest mode says.
    pub(crate) fn growth(&self) -> Growth {
        let is_found = |finding: &Finding| matches!(finding.kind, UnstableStep | GrowsAlways);
        let Some(leading) = self.modes.first() else { return Growth::None };
        if leading.radius <= 1.0 + GROWTH || leading.step.growth_rate <= 10.0 * leading.error {
            return Growth::None;
        }
        if self.flow.is_some() && self.findings.iter().any(is_found) {
            return Growth::OfStep;
        }
        match leading.flow {
            Some(flow) if flow.growth_rate > 10.0 * leading.error => Growth::OfSystem,
            // Along a motion the rates change within a step, and say nothing of its stability.
            Some(_) if !self.equilibrium.holds => Growth::None,
            _ => Growth::Unknown,
        }
    }

    fn not_examined(&self) -> Vec<&'static str> {
        let mut parts = Vec::new();
        if self.step.is_none() {
            return parts;
        }
        if self.flow.is_none() {
            parts.push("modes of the system and the longest stable step");
        } else if !self.equilibrium.holds {
            parts.push("stability along the motion");
        }
        if self.order.is_none() {
            parts.push("order and integrator");
        }
        if self.memory.as_ref().is_some_and(|memory| {
            let is_of_step = matches!(memory.observed, Some(Observed::Asked));
            is_of_step && memory.observed_age.is_none()
        }) {
            parts.push("observations that are old by up to a step");
        }
        let energy = self.defects.as_ref().and_then(|defects| defects.energy.as_ref());
        if energy.is_some_and(|energy| energy.is_unexamined()) {
            parts.push("drift of the energy");
        }
        parts
    }
}
