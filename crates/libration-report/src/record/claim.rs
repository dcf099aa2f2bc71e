//! Claims of the source report, judged by findings.

use serde::{Deserialize, Serialize};

use super::{Agreement, Finding};

/// The verdict on a claim.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum ClaimVerdict {
    /// It holds as it stands.
    Confirmed,
    /// It holds under a condition that the source does not state.
    Conditional,
    /// It does not hold.
    Refuted,
    /// The source does not say enough to try it.
    NotReproducible,
    /// A finding that decides it disagrees with theory.
    Undecided,
}

impl ClaimVerdict {
    /// The verdict in words.
    pub fn name(self) -> &'static str {
        match self {
            ClaimVerdict::Confirmed => "confirmed",
            ClaimVerdict::Conditional => "conditional",
            ClaimVerdict::Refuted => "refuted",
            ClaimVerdict::NotReproducible => "not reproducible",
            ClaimVerdict::Undecided => "undecided",
        }
    }
}

/// A verdict with its reason.
#[derive(Clone, Debug, PartialEq)]
pub struct Judgement {
    verdict: ClaimVerdict,
    condition: Option<String>,
    because: String,
}

impl Judgement {
    fn new(verdict: ClaimVerdict, because: impl Into<String>) -> Self {
        Judgement { verdict, condition: None, because: because.into() }
    }

    /// The claim holds as it stands.
    pub fn confirmed(because: impl Into<String>) -> Self {
        Judgement::new(ClaimVerdict::Confirmed, because)
    }

    /// The claim holds under a condition; the reason names it, and the side on which the
    /// source's own setting lies.
    pub fn conditional(because: impl Into<String>) -> Self {
        Judgement::new(ClaimVerdict::Conditional, because)
    }

    /// Adds the condition of a conditional verdict in a few words.
    #[must_use]
    pub fn only(mut self, condition: impl Into<String>) -> Self {
        self.condition = Some(condition.into());
        self
    }

    /// The claim does not hold.
    pub fn refuted(because: impl Into<String>) -> Self {
        Judgement::new(ClaimVerdict::Refuted, because)
    }

    /// The source does not say enough to try the claim.
    pub fn not_reproducible(because: impl Into<String>) -> Self {
        Judgement::new(ClaimVerdict::NotReproducible, because)
    }

    /// Confirmed if `holds`, refuted otherwise.
    pub fn holds_if(holds: bool, because: impl Into<String>) -> Self {
        if holds { Judgement::confirmed(because) } else { Judgement::refuted(because) }
    }
}

/// A claim to judge, and the findings that decide it.
#[derive(Clone, Copy, Debug)]
pub struct Ruling<'a> {
    /// Number in the ledger, as in `C16`.
    pub id: &'a str,
    /// Section of the source report.
    pub source: &'a str,
    /// The statement of the source, paraphrased.
    pub text: &'a str,
    /// Identifiers of the findings that decide.
    pub findings: &'a [&'a str],
}

/// A judged claim.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
pub struct Claim {
    /// Number in the ledger.
    pub id: String,
    /// Section of the source report.
    pub source: String,
    /// The statement of the source, paraphrased.
    pub text: String,
    /// The verdict.
    pub verdict: ClaimVerdict,
    /// Where a conditional verdict holds, in a few words.
    pub condition: Option<String>,
    /// The reason.
    pub because: String,
    /// Identifiers of the findings that decided.
    pub findings: Vec<String>,
}

impl Claim {
    pub(super) fn new(ruling: &Ruling<'_>, evidence: &[&Finding], judgement: Judgement) -> Self {
        let broken: Vec<&str> = evidence
            .iter()
            .filter(|f| f.verdict == Agreement::Disagrees)
            .map(|f| f.id.as_str())
            .collect();
        let Judgement { verdict, condition, because } = if broken.is_empty() {
            judgement
        } else {
            Judgement::new(
                ClaimVerdict::Undecided,
                format!("measurement and theory disagree in {}", broken.join(", ")),
            )
        };
        Claim {
            id: ruling.id.into(),
            source: ruling.source.into(),
            text: ruling.text.into(),
            verdict,
            condition,
            because,
            findings: ruling.findings.iter().map(|&id| id.into()).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Record, Tolerance};
    use super::*;

    fn judged(measured: f64) -> Claim {
        let mut record = Record::new("study", "?");
        let exact = Tolerance::exact("");
        record.find(Finding::predicted("study.x", "", "1", 1.0, measured, exact));
        let ruling = Ruling { id: "C1", source: "2", text: "", findings: &["study.x"] };
        record.judge(ruling, |_| Judgement::confirmed("it is so"));
        record.claims.remove(0)
    }

    #[test]
    fn no_claim_is_decided_by_a_finding_that_disagrees_with_theory() {
        assert_eq!(judged(1.0).verdict, ClaimVerdict::Confirmed);
        assert_eq!(judged(2.0).verdict, ClaimVerdict::Undecided);
    }

    #[test]
    fn a_claim_without_its_evidence_stays_unjudged() {
        let ruling = Ruling { id: "C1", source: "2", text: "", findings: &["study.x"] };
        let mut record = Record::new("study", "?");
        record.judge(ruling, |_| Judgement::confirmed(""));
        assert!(record.claims.is_empty());
    }
}
