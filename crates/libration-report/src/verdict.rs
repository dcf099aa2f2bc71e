//! Verdicts: the one place in which a result is called good, bad or unknown.

use core::f64::consts::FRAC_PI_2;
use std::fmt;

use serde::{Deserialize, Serialize};

/// What a command says of a step, a motion, a loop or a simulator, with its evidence.
///
/// A sentence such as "stable" or "no fault" is printed from a verdict only, and exit codes follow from verdicts by [`exit_code`].
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Verdict {
    /// The outcome.
    pub outcome: Outcome,
    /// The number or fact that decides, in words: `spectral radius 1.0021`. Of [`Outcome::Unknown`], the reason.
    pub evidence: String,
    /// What the command did not examine, each in words: `2 wrappers`, `lateness of discrete actions`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub not_examined: Vec<String>,
}

/// The outcome of an examination.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Outcome {
    /// Deviations do not grow, or grow only as those of the exact system do.
    Stable,
    /// Deviations grow.
    Unstable,
    /// The errors of a motion are small beside it, over all steps of the request.
    Resolved,
    /// The errors of a motion are not small beside it.
    NotResolved,
    /// A quantity is within its stated tolerance.
    Within,
    /// A quantity exceeds its stated tolerance.
    Exceeds,
    /// Everything that was examined has no fault.
    NoFault,
    /// Something has a fault.
    Fault,
    /// The evidence does not decide.
    Unknown,
}

/// Exit code of a command whose verdicts are all good.
pub const GOOD: u8 = 0;

/// Exit code of a command with a bad or an unknown verdict.
pub const NOT_GOOD: u8 = 1;

impl Outcome {
    /// Whether the outcome is what a user hopes for. Unknown is not.
    pub fn is_good(self) -> bool {
        match self {
            Outcome::Stable | Outcome::Resolved | Outcome::Within | Outcome::NoFault => true,
            Outcome::Unstable
            | Outcome::NotResolved
            | Outcome::Exceeds
            | Outcome::Fault
            | Outcome::Unknown => false,
        }
    }

    /// The outcome in words, as in sentences and JSON.
    pub fn name(self) -> &'static str {
        match self {
            Outcome::Stable => "stable",
            Outcome::Unstable => "unstable",
            Outcome::Resolved => "resolved",
            Outcome::NotResolved => "not resolved",
            Outcome::Within => "within",
            Outcome::Exceeds => "exceeds",
            Outcome::NoFault => "no fault",
            Outcome::Fault => "fault",
            Outcome::Unknown => "unknown",
        }
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl Verdict {
    /// A verdict with the number or fact that decides.
    pub fn new(outcome: Outcome, evidence: impl Into<String>) -> Self {
        Verdict { outcome, evidence: evidence.into(), not_examined: Vec::new() }
    }

    /// A verdict that the evidence does not allow, for a reason.
    pub fn unknown(reason: impl Into<String>) -> Self {
        Verdict::new(Outcome::Unknown, reason)
    }

    /// The same verdict, with a part of the subject that was not examined.
    #[must_use]
    pub fn without(mut self, part: impl Into<String>) -> Self {
        self.not_examined.push(part.into());
        self
    }

    /// Whether the outcome is good.
    pub fn is_good(&self) -> bool {
        self.outcome.is_good()
    }

    /// What was not examined, as a sentence; empty if that is nothing.
    pub fn limits(&self) -> String {
        match self.not_examined.is_empty() {
            true => String::new(),
            false => format!("Not examined: {}.", self.not_examined.join(", ")),
        }
    }
}

impl fmt::Display for Verdict {
    /// `stable: spectral radius 0.998`, with what was not examined behind it.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.outcome)?;
        if !self.evidence.is_empty() {
            write!(f, ": {}", self.evidence)?;
        }
        if !self.not_examined.is_empty() {
            write!(f, " (not examined: {})", self.not_examined.join(", "))?;
        }
        Ok(())
    }
}

/// The exit code of a command that ends with these verdicts: [`GOOD`] if all are good, else [`NOT_GOOD`].
pub fn exit_code<'a>(verdicts: impl IntoIterator<Item = &'a Verdict>) -> u8 {
    match verdicts.into_iter().all(Verdict::is_good) {
        true => GOOD,
        false => NOT_GOOD,
    }
}

/// The factor between the growth rates of a growing mode in steps and in exact steps up to which steps follow it.
pub const FOLLOWED: f64 = 2.0;

/// Whether a step follows a mode that grows, by the logarithm of its growth in a step and its angle in rad, of the step and of an exact
/// one. A mode that the step turns by more than a quarter of a turn moves the other way.
pub fn follows_growth([own, angle]: [f64; 2], [exact, exact_angle]: [f64; 2]) -> bool {
    let is_turned = (angle - exact_angle).abs() > FRAC_PI_2;
    !is_turned && own * FOLLOWED >= exact && own <= FOLLOWED * exact
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_unknown_among_good_verdicts_is_no_success() {
        let stable = Verdict::new(Outcome::Stable, "spectral radius 0.9");
        assert_eq!(exit_code([&stable, &stable]), GOOD);
        let unknown = Verdict::unknown("the search did not converge");
        assert_eq!(exit_code([&stable, &unknown]), NOT_GOOD);
    }

    #[test]
    fn what_was_not_examined_is_in_the_text_and_in_json() {
        let verdict = Verdict::new(Outcome::NoFault, "12 checks").without("2 wrappers");
        assert_eq!(verdict.to_string(), "no fault: 12 checks (not examined: 2 wrappers)");
        let json = serde_json::to_value(&verdict).unwrap();
        assert_eq!(json["outcome"], "no-fault");
        assert_eq!(json["not_examined"][0], "2 wrappers");
    }
}
