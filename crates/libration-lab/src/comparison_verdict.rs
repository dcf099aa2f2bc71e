//! The verdict on a comparison of two runs.

use libration_report::notation::plural;
use libration_report::verdict::{Outcome, Verdict};

use crate::ResultsComparison;

impl ResultsComparison {
    /// Each way in which the second run is worse, in words.
    pub fn failures(&self) -> Vec<String> {
        let of = |count: usize, one: &str, more: &str| match count {
            0 => None,
            1 => Some(one.to_owned()),
            n => Some(format!("{n} {more}")),
        };
        let claims = self.claims.iter().filter(|claim| claim.is_lost).count();
        let misstated = (!self.misstated.is_empty())
            .then(|| format!("judged and undecided at once: {}", self.misstated.join(", ")));
        let unfinished =
            self.is_unfinished.then(|| "the first run is complete, the second is not".to_owned());
        let failures = [
            of(self.regressions.len(), "a finding became worse", "findings became worse"),
            of(
                self.lost.len(),
                "a finding of the first run missing in the second",
                "findings of the first run missing in the second",
            ),
            of(claims, "a claim has another verdict", "claims have other verdicts"),
            of(
                self.moved.len(),
                "the prediction of a finding changed",
                "findings have other predictions",
            ),
            misstated,
            unfinished,
        ];
        failures.into_iter().flatten().collect()
    }

    /// The verdict, with what one run alone has. `is_complete` says whether each run is.
    pub(crate) fn judge(&self, is_complete: [bool; 2]) -> Verdict {
        let failures = self.failures();
        let counts = self.counts();
        let verdict = match self.compared {
            _ if !failures.is_empty() => {
                Verdict::new(Outcome::Fault, format!("{}; {counts}", failures.join(", ")))
            }
            0 => Verdict::unknown(format!("no finding was compared; {counts}")),
            _ => Verdict::new(Outcome::NoFault, format!("nothing became worse; {counts}")),
        };
        let is_in_another_unit = |change: &&crate::Change| change.unit_before.is_some();
        let others = self.changed.iter().filter(is_in_another_unit).count();
        let parts = [
            (self.only_before.len(), "of the first run alone"),
            (self.only_after.len(), "of the second run alone"),
            (others, "in another unit"),
            (self.undecided.len(), "that the second run left undecided"),
        ];
        let verdict = parts.into_iter().filter(|&(count, _)| count > 0).fold(
            verdict,
            |verdict, (count, what)| {
                verdict.without(format!("{} {what}", plural(count, "finding")))
            },
        );
        match is_complete {
            [true, true] => verdict,
            [false, true] => verdict.without("the rest of the first run"),
            [true, false] => verdict.without("the rest of the second run"),
            [false, false] => verdict.without("the rest of both runs"),
        }
    }

    /// The numbers of findings.
    fn counts(&self) -> String {
        let is = |count: usize, one: &str, more: &str| match count {
            1 => format!("1 {one}"),
            n => format!("{n} {more}"),
        };
        let mut counts = vec![
            is(self.same, "finding is the same", "findings are the same"),
            format!("{} within their tolerance or noise", self.within),
        ];
        let differing = self.changed.len();
        if differing > 0 {
            counts.push(is(differing, "differs", "differ"));
        }
        if self.disagreeing > 0 {
            let disagree = is(self.disagreeing, "disagrees", "disagree");
            counts.push(format!("{disagree} with theory in both"));
        }
        counts.join(", ")
    }
}
