//! Two results of `lab`, finding by finding.

use std::collections::HashMap;

use libration_report::record::{Agreement, Finding};
use libration_report::verdict::Verdict;
use serde::Serialize;

use crate::claim_changes::{ClaimChange, claim_changes};
use crate::compared_results::ComparedResults;
use crate::finding_pair::{change, is_loosened, is_misstated, is_moved, is_within, verdict};
use crate::run_conditions::{Condition, differing};

/// Findings of two runs, compared.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ResultsComparison {
    /// Whether something became worse; unknown if no finding was compared.
    pub verdict: Verdict,
    /// Findings of both runs in the same unit, with a number in one of them.
    pub compared: usize,
    /// What differs between the runs themselves: the machine, the version, keys of the configuration.
    pub conditions: Vec<Condition>,
    /// Findings with the same bits.
    pub same: usize,
    /// Findings whose difference is within the tolerance of theory, or that of speeds.
    pub within: usize,
    /// Findings that became worse: theory contradicts what it did not before, or a rate fell or is missing.
    pub regressions: Vec<Change>,
    /// Findings that became better in the same sense.
    pub improvements: Vec<Change>,
    /// Other findings that differ.
    pub changed: Vec<Change>,
    /// Findings that agree with another prediction than before, by more than its tolerance and under the same settings.
    pub moved: Vec<Change>,
    /// Findings of either run that are judged and undecided at once.
    pub misstated: Vec<String>,
    /// Whether the second run is unfinished and the first is not.
    pub is_unfinished: bool,
    /// Findings that disagree with theory in both runs.
    pub disagreeing: usize,
    /// Findings that theory predicted in the first run, and that the second left undecided.
    pub undecided: Vec<String>,
    /// Findings of the first run that theory predicted, and that the second run should have as well.
    pub lost: Vec<String>,
    /// Claims whose verdicts differ.
    pub claims: Vec<ClaimChange>,
    /// Findings of the first run alone.
    pub only_before: Vec<String>,
    /// Findings of the second run alone.
    pub only_after: Vec<String>,
}

/// A finding that differs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Change {
    /// Its identifier.
    pub id: String,
    /// What was measured, in words.
    pub text: String,
    /// Unit of both measurements.
    pub unit: String,
    /// Measured in the first run; `null` in a file if it is not finite.
    pub before: f64,
    /// Measured in the second run.
    pub after: f64,
    /// The prediction of the second run, if there is one.
    pub predicted: Option<f64>,
    /// The tolerance of the second run, if there is one.
    pub tolerance: Option<f64>,
    /// Verdicts of both runs.
    pub verdicts: [Agreement; 2],
    /// The predictions of both runs, if they differ.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub predictions: Option<[Option<f64>; 2]>,
    /// Unit of the first measurement, if it is another one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unit_before: Option<String>,
}

/// The largest relative change of a measurement without a prediction that is taken for noise, unless the user says otherwise.
pub const NOISE: f64 = 0.2;

impl ResultsComparison {
    /// Compares two results. Measurements without a prediction, which are speeds for the most part, may differ by `noise` of the first.
    pub fn new(before: &ComparedResults, after: &ComparedResults, noise: f64) -> Self {
        let known: HashMap<&str, &Finding> =
            after.findings().map(|finding| (finding.id.as_str(), finding)).collect();
        let old: HashMap<&str, &Finding> =
            before.findings().map(|finding| (finding.id.as_str(), finding)).collect();
        let all = before.findings().chain(after.findings());
        let mut comparison = ResultsComparison {
            verdict: Verdict::unknown(""),
            compared: 0,
            conditions: conditions(before, after),
            same: 0,
            within: 0,
            regressions: Vec::new(),
            improvements: Vec::new(),
            changed: Vec::new(),
            moved: Vec::new(),
            misstated: all.filter(|one| is_misstated(one)).map(|one| one.id.clone()).collect(),
            is_unfinished: before.complete && !after.complete,
            disagreeing: 0,
            undecided: Vec::new(),
            lost: Vec::new(),
            claims: claim_changes(before.claims(), after.claims(), |study| {
                after.should_have(before, study)
            }),
            only_before: Vec::new(),
            only_after: Vec::new(),
        };
        for first in before.findings() {
            match known.get(first.id.as_str()) {
                Some(second) => {
                    comparison.add(first, second, noise, after.should_have(before, &first.id));
                }
                None => {
                    comparison.only_before.push(first.id.clone());
                    if first.verdict != Agreement::Measured && after.should_have(before, &first.id)
                    {
                        comparison.lost.push(first.id.clone());
                    }
                }
            }
        }
        for new in after.findings().filter(|finding| !old.contains_key(finding.id.as_str())) {
            comparison.only_after.push(new.id.clone());
            if verdict(new) == Agreement::Disagrees {
                comparison.regressions.push(change(None, new));
            }
        }
        comparison.misstated.sort();
        comparison.misstated.dedup();
        comparison.verdict = comparison.judge([before, after].map(ComparedResults::is_complete));
        comparison
    }

    /// Adds a finding of both runs. `is_alike` says whether their settings are the same.
    fn add(&mut self, first: &Finding, second: &Finding, noise: f64, is_alike: bool) {
        let is_number = !(first.measured.is_nan() && second.measured.is_nan());
        self.compared += usize::from(first.unit == second.unit && is_number);
        let verdicts = [verdict(first), verdict(second)];
        self.disagreeing += usize::from(verdicts == [Agreement::Disagrees; 2]);
        if verdicts == [Agreement::Agrees, Agreement::Measured] {
            match second.undecided {
                Some(_) => self.undecided.push(second.id.clone()),
                None if is_alike => return self.regressions.push(change(Some(first), second)),
                None => {}
            }
        }
        if is_moved(first, second) {
            let list = if is_alike { &mut self.moved } else { &mut self.changed };
            return list.push(change(Some(first), second));
        }
        let change = || change(Some(first), second);
        let difference = second.measured - first.measured;
        // Files have no infinities: both are NaN then.
        let is_equal = difference == 0.0 || first.measured.is_nan() && second.measured.is_nan();
        let is_lost = second.measured.is_nan() && !first.measured.is_nan();
        let fell = difference < -noise * first.measured.abs() || is_lost;
        let rose = difference > noise * first.measured.abs();
        let is_rate = second.unit.ends_with("/s");
        let is_another = first.unit != second.unit || first.relation != second.relation;
        match (verdict(first), verdict(second)) {
            (Agreement::Agrees, Agreement::Agrees) if is_lost => self.regressions.push(change()),
            (Agreement::Agrees, Agreement::Agrees) if is_loosened(first, second) => {
                let verdicts = [Agreement::Agrees, Agreement::Disagrees];
                let tolerance = first.tolerance.tolerance;
                self.regressions.push(Change { tolerance, verdicts, ..change() });
            }
            (Agreement::Agrees | Agreement::Measured, Agreement::Disagrees) => {
                self.regressions.push(change())
            }
            (Agreement::Disagrees, Agreement::Agrees) if is_loosened(first, second) => {
                let verdicts = [Agreement::Disagrees; 2];
                let tolerance = first.tolerance.tolerance;
                self.disagreeing += 1;
                self.changed.push(Change { tolerance, verdicts, ..change() });
            }
            (Agreement::Disagrees, Agreement::Agrees) => self.improvements.push(change()),
            // A rate in another unit may have fallen.
            (Agreement::Measured, _) if first.unit.ends_with("/s") && first.unit != second.unit => {
                self.regressions.push(change())
            }
            (before, after) if is_another || before != after => self.changed.push(change()),
            _ if is_equal && first.predicted == second.predicted => self.same += 1,
            (Agreement::Measured, _) if is_rate && fell => self.regressions.push(change()),
            (Agreement::Measured, _) if is_rate && rose => self.improvements.push(change()),
            (Agreement::Measured, _) if !(fell || rose || difference.is_nan()) => self.within += 1,
            _ if is_within(first, second) => self.within += 1,
            _ => self.changed.push(change()),
        }
    }
}

/// The conditions that differ.
fn conditions(before: &ComparedResults, after: &ComparedResults) -> Vec<Condition> {
    let is_complete = [before, after].map(|results| results.complete.to_string());
    let [first, second] = is_complete;
    let incomplete = (before.complete != after.complete).then(|| Condition {
        key: "complete".to_owned(),
        before: first,
        after: second,
    });
    let machine = differing("machine", [&before.machine, &after.machine]);
    let config = differing("config", [&before.config, &after.config]);
    incomplete.into_iter().chain(machine).chain(config).collect()
}
