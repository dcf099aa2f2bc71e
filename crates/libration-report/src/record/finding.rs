//! Findings: predictions and measurements.

use std::fmt;

use serde::{Deserialize, Deserializer, Serialize};

/// A measured number with the prediction of theory.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
pub struct Finding {
    /// Identifier, unique in the report: `study.subject.quantity`.
    pub id: String,
    /// The measured quantity, in words.
    pub text: String,
    /// Unit of both numbers; `1` if there is none.
    pub unit: String,
    /// The prediction, if there is one.
    pub predicted: Option<f64>,
    /// The measurement; NaN where a file has none.
    #[serde(deserialize_with = "number_or_nan")]
    pub measured: f64,
    /// The expected relation of the measurement to the prediction.
    pub relation: Relation,
    /// The allowed difference and its reason.
    #[serde(flatten)]
    pub tolerance: Tolerance,
    /// Whether they agree; the key of the format stays `verdict`.
    pub verdict: Agreement,
    /// The reason why a measurement could not be judged.
    pub undecided: Option<Undecided>,
    /// The command that recomputes this finding alone; empty outside of results that a run wrote.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub command: String,
}

/// JSON has no infinity and no NaN: both are `null` in `results.json`.
fn number_or_nan<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    Option::deserialize(deserializer).map(|x| x.unwrap_or(f64::NAN))
}

/// The reason why a measurement could not be judged.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq, Eq)]
#[serde(untagged)]
pub enum Undecided {
    /// The measurement was too noisy; another run may judge it.
    Noisy(String),
    /// The target, which no theory predicts, was not reached.
    Beyond(String),
}

impl fmt::Display for Undecided {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (Undecided::Noisy(reason) | Undecided::Beyond(reason)) = self;
        f.write_str(reason)
    }
}

/// The expected relation of a measurement to its prediction.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum Relation {
    /// Equal, within the tolerance.
    Equal,
    /// Not above the prediction by more than the tolerance.
    AtMost,
    /// Not below the prediction by more than the tolerance.
    AtLeast,
}

/// The verdict on a finding.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum Agreement {
    /// The measurement agrees with the prediction.
    Agrees,
    /// The measurement disagrees with the prediction.
    Disagrees,
    /// There is no prediction.
    Measured,
}

/// The largest difference that counts as agreement.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
pub struct Tolerance {
    /// The largest allowed absolute difference, in the finding's unit.
    pub tolerance: Option<f64>,
    /// The reason for the tolerance.
    pub tolerance_reason: String,
    #[serde(skip)]
    relative: bool,
}

impl Tolerance {
    /// At most `size`, in the unit of the finding.
    pub fn absolute(size: f64, reason: impl Into<String>) -> Self {
        Tolerance { tolerance: Some(size), tolerance_reason: reason.into(), relative: false }
    }

    /// At most `size` times the prediction.
    pub fn relative(size: f64, reason: impl Into<String>) -> Self {
        Tolerance { tolerance: Some(size), tolerance_reason: reason.into(), relative: true }
    }

    /// No difference at all.
    pub fn exact(reason: impl Into<String>) -> Self {
        Tolerance::absolute(0.0, reason)
    }
}

impl Relation {
    /// Whether a measurement is as related to a prediction as expected, within the allowed difference; false for what is not a number.
    pub fn holds(self, predicted: f64, measured: f64, allowed: Option<f64>) -> bool {
        let difference = measured - predicted;
        let excess = match self {
            Relation::Equal => difference.abs(),
            Relation::AtMost => difference,
            Relation::AtLeast => -difference,
        };
        allowed.is_some_and(|allowed| excess <= allowed)
    }
}

impl Finding {
    /// A measurement that should equal a prediction.
    pub fn predicted(
        id: impl Into<String>,
        text: impl Into<String>,
        unit: &str,
        predicted: f64,
        measured: f64,
        tolerance: Tolerance,
    ) -> Self {
        Finding::related(id, text, unit, Relation::Equal, predicted, measured, tolerance)
    }

    /// A measurement that should stay within a predicted bound.
    pub fn related(
        id: impl Into<String>,
        text: impl Into<String>,
        unit: &str,
        relation: Relation,
        predicted: f64,
        measured: f64,
        mut tolerance: Tolerance,
    ) -> Self {
        if tolerance.relative {
            tolerance.tolerance = tolerance.tolerance.map(|size| size * predicted.abs());
        }
        let agrees = relation.holds(predicted, measured, tolerance.tolerance);
        Finding {
            id: id.into(),
            text: text.into(),
            unit: unit.into(),
            predicted: Some(predicted),
            measured,
            relation,
            tolerance,
            verdict: if agrees { Agreement::Agrees } else { Agreement::Disagrees },
            undecided: None,
            command: String::new(),
        }
    }

    /// A measurement without a prediction.
    pub fn measured(
        id: impl Into<String>,
        text: impl Into<String>,
        unit: &str,
        measured: f64,
    ) -> Self {
        Finding {
            id: id.into(),
            text: text.into(),
            unit: unit.into(),
            predicted: None,
            measured,
            relation: Relation::Equal,
            tolerance: Tolerance {
                tolerance: None,
                tolerance_reason: "no prediction exists".into(),
                relative: false,
            },
            verdict: Agreement::Measured,
            undecided: None,
            command: String::new(),
        }
    }

    /// The same finding, not judged because of `reason`.
    #[must_use]
    pub fn undecided(self, reason: Undecided) -> Self {
        Finding { undecided: Some(reason), ..self }
    }

    /// Whether the measurement agrees with the prediction.
    pub fn agrees(&self) -> bool {
        self.verdict == Agreement::Agrees
    }

    /// Whether a nonzero prediction agrees but is no larger than its tolerance, so that zero would agree too.
    pub fn agrees_with_zero(&self) -> bool {
        let small = |p: f64| p != 0.0 && self.tolerance.tolerance.is_some_and(|t| t >= p.abs());
        self.agrees() && self.relation == Relation::Equal && self.predicted.is_some_and(small)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn equal(predicted: f64, measured: f64, tolerance: Tolerance) -> Agreement {
        Finding::predicted("a.b", "", "1", predicted, measured, tolerance).verdict
    }

    #[test]
    fn a_relative_tolerance_scales_with_the_prediction() {
        assert_eq!(equal(200.0, 201.0, Tolerance::relative(0.01, "")), Agreement::Agrees);
        assert_eq!(equal(2.0, 3.0, Tolerance::relative(0.01, "")), Agreement::Disagrees);
    }

    #[test]
    fn what_is_not_a_number_never_agrees() {
        for (p, m) in [(f64::NAN, 1.0), (1.0, f64::NAN), (f64::INFINITY, f64::INFINITY)] {
            assert_eq!(equal(p, m, Tolerance::relative(1.0, "")), Agreement::Disagrees);
        }
    }

    #[test]
    fn a_prediction_below_its_tolerance_says_no_more_than_zero() {
        let found = |p, size| {
            Finding::predicted("a.b", "", "1", p, p, Tolerance::absolute(size, ""))
                .agrees_with_zero()
        };
        assert!(found(1e-3, 1e-2) && found(-1e-3, 1e-3));
        assert!(!found(1e-3, 1e-4) && !found(0.0, 1.0));
    }

    #[test]
    fn a_bound_is_one_sided() {
        let at_most = |m| {
            let none = Tolerance::exact("");
            Finding::related("a.b", "", "1", Relation::AtMost, 1.0, m, none).verdict
        };
        assert_eq!(at_most(-5.0), Agreement::Agrees);
        assert_eq!(at_most(1.1), Agreement::Disagrees);
    }
}
