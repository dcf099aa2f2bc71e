//! The answer of an audit, in sentences.

use libration_report::notation::{number, plural};
use libration_report::verdict::Outcome;

use crate::modes::ProbedMode;
use crate::unknown_error::is_unknown_error;
use crate::verdict::Growth;
use crate::{FindingKind, ProbeReport};

impl ProbeReport {
    /// The answer in a few sentences: faults first.
    pub(crate) fn summary(&self) -> String {
        let mut sentences = Vec::new();
        let is_fault = self.findings.iter().any(|f| f.kind == FindingKind::OperatingPoint);
        sentences.extend(
            self.operating_point.as_ref().filter(|_| !is_fault).and_then(|point| point.sentence()),
        );
        let faults = self.findings.iter().filter(|finding| finding.is_fault).count();
        match (self.verdict.outcome, faults) {
            (Outcome::Fault, 1) => {
                sentences.push(format!("One fault: {}.", self.verdict.evidence));
            }
            (Outcome::Fault, _) => sentences.push(format!("{}.", self.verdict.evidence)),
            (Outcome::NotResolved, _) => sentences.push(format!(
                "The step does not follow a growing motion: {}.",
                self.verdict.evidence
            )),
            (Outcome::Unknown, _) => sentences.push(format!(
                "Whether the step has a fault is unknown: {}.",
                self.verdict.evidence
            )),
            _ => {}
        }
        if self.is_differentiable() {
            sentences.extend(self.stability());
            sentences.extend(self.integrator());
            sentences.extend(self.damping());
        } else if self.step.is_some() {
            sentences.push(
                "The step has no derivative at this state: a contact, a limit or dry friction changes there. Its modes, its longest stable \
                 step and its latency say nothing about its motion."
                    .into(),
            );
        }
        let validity =
            self.findings.iter().filter(|finding| finding.kind == FindingKind::LimitedValidity);
        sentences.extend(validity.map(|finding| format!("{}.", capitalised(&finding.text))));
        if self.verdict.outcome == Outcome::NoFault {
            let warnings: Vec<&str> = self
                .findings
                .iter()
                .filter(|finding| finding.kind != FindingKind::LimitedValidity)
                .map(|finding| finding.text.as_str())
                .collect();
            let verdict = capitalised(self.verdict.outcome.name());
            sentences.push(match warnings[..] {
                [] => format!("{verdict} was found."),
                [only] => format!("{verdict} was found, but 1 warning: {only}."),
                [first, ..] => format!(
                    "{verdict} was found, but {}, the first: {first}.",
                    plural(warnings.len(), "warning")
                ),
            });
        }
        sentences.extend(Some(self.verdict.limits()).filter(|limits| !limits.is_empty()));
        sentences.join(" ")
    }

    fn stability(&self) -> Option<String> {
        self.step.as_ref()?;
        let dt = number(self.dt, 6);
        let leading = self.modes.first()?;
        let growth = format!("grows at {} 1/s", number(leading.step.growth_rate, 4));
        let names = leading.names();
        let is_at_rest = self.equilibrium.holds;
        let is_neutral = leading.radius <= 1.0 + 1e-9;
        let is_stable = match self.growth() {
            Growth::OfStep => !is_at_rest && is_neutral,
            Growth::None => is_at_rest || is_neutral,
            Growth::OfSystem | Growth::Unknown => false,
        };
        let mut text = match self.growth() {
            _ if is_stable => format!("With dt = {dt} s the step is stable at this state"),
            Growth::OfSystem => {
                format!("With dt = {dt} s a mode {growth}, as in the system itself ({names})")
            }
            Growth::OfStep if is_at_rest => {
                format!("With dt = {dt} s the step is unstable: a mode {growth} ({names})")
            }
            Growth::Unknown => format!(
                "With dt = {dt} s a mode of the step {growth} ({names}), and whether it does so in the system is unknown"
            ),
            Growth::OfStep | Growth::None => {
                format!("With dt = {dt} s a mode of deviations from the motion {growth} ({names})")
            }
        };
        // The fault comes first, and has the limit.
        let is_known =
            self.findings.iter().any(|finding| finding.kind == FindingKind::UnstableStep);
        let limit = self.largest_dt.as_ref().filter(|_| !is_known);
        match limit {
            Some(limit) if limit.grows_always => {
                text += "; no step is short enough to prevent growth of its own";
            }
            Some(limit) if let Some(longest) = limit.dt => {
                text += &format!(
                    "; the longest stable step is {} s ({} times dt), limited by the mode of {}",
                    number(longest, 6),
                    number(longest / self.dt, 3),
                    limit.mode
                );
            }
            Some(limit) => {
                let longest = number(limit.tried_up_to, 3);
                let why = limit.reason.as_ref().map_or_else(String::new, |why| format!(": {why}"));
                text += &format!("; no limit was found up to a step of {longest} s{why}");
            }
            None => {}
        }
        if let Some(from) = limit.and_then(|limit| limit.rests_elsewhere_from) {
            text += &format!(
                "; longer steps were examined at their own equilibria, which are other states from {} s on",
                number(from, 3)
            );
            let is_mujoco = self.version.as_ref().is_some_and(|v| v.starts_with("MuJoCo"));
            if is_mujoco && !text.contains("refsafe") {
                text += " (refsafe: contacts give way where dt exceeds half the time constant of solref)";
            }
        }
        if is_stable {
            text += "; ";
            text += &self.unseen_growth();
        }
        Some(text + ".")
    }

    fn integrator(&self) -> Option<String> {
        let recognition = self.recognition.as_ref()?;
        let by_results = recognition.by_results.titles();
        let by_matrix = recognition.by_matrix.as_ref().map(|by| by.titles()).unwrap_or_default();
        let (titles, by) = match by_results.is_empty() {
            true => (by_matrix, "its matrix"),
            false => (by_results, "its results"),
        };
        if self.order.as_ref().is_some_and(|order| order.is_exact) {
            return Some(
                "The step is exact to rounding: shorter steps give the same results.".into(),
            );
        }
        let order = self.order.as_ref().and_then(|order| order.order);
        match (&titles[..], order) {
            ([], Some(order)) if !recognition.by_results.is_clear => Some(format!(
                "Its order is {order}; its motion near this state does not tell integrators apart."
            )),
            ([], Some(order)) => Some(format!(
                "Its order is {order}; it is none of the integrators that were compared."
            )),
            ([], None) => None,
            (titles, order) => {
                let order = order.map_or_else(String::new, |order| format!(", of order {order}"));
                Some(format!("By {by} the step is that of {}{order}.", titles.join(" or ")))
            }
        }
    }

    fn damping(&self) -> Option<String> {
        let most =
            self.modes.iter().filter(|mode| mode.numerical_damping.is_some()).max_by(|a, b| {
                let size = |mode: &ProbedMode| mode.numerical_damping.unwrap_or(0.0).abs();
                size(a).total_cmp(&size(b))
            })?;
        let added = most.numerical_damping.filter(|added| added.abs() > 1e-6)?;
        let (verb, to) = if added > 0.0 { ("adds", "to") } else { ("takes", "from") };
        Some(format!(
            "It {verb} a damping ratio of {} {to} the mode of {}.",
            number(added.abs(), 3),
            most.names()
        ))
    }
}

impl ProbedMode {
    /// The states that move most, in words.
    pub fn names(&self) -> String {
        let names: Vec<&str> = self.states.iter().map(|(name, _)| name.as_str()).collect();
        names.join(", ")
    }
}

/// A relative error of a result; one above 1 says nothing but that the result is wrong.
pub fn error_in_words(error: f64) -> String {
    if is_unknown_error(error) { "unknown".into() } else { number(error, 2) }
}

pub(crate) fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}
