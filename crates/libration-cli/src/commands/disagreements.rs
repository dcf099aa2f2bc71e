//! Findings that disagree with theory.

use libration_report::record::{Finding, Record};

use crate::error::Failure;
use crate::terminal;

/// Prints each finding that disagrees, and fails if there is one.
pub(super) fn check_findings(records: &[Record]) -> Result<(), Failure> {
    let disagree: Vec<&Finding> = records.iter().flat_map(Record::disagreements).collect();
    for finding in &disagree {
        terminal::error(&disagreement(finding));
    }
    if disagree.is_empty() { Ok(()) } else { Err(Failure::Disagreement) }
}

fn disagreement(finding: &Finding) -> String {
    let Finding { id, text, unit, predicted, measured, tolerance, .. } = finding;
    let number = |x: &Option<f64>| x.map_or_else(|| "none".to_owned(), |x| format!("{x:?}"));
    let (predicted, tolerance) = (number(predicted), number(&tolerance.tolerance));
    format!(
        "the finding `{id}` disagrees: predicted {predicted}, measured {measured:?}, \
         tolerance {tolerance}, in units of {unit}\n  {text}"
    )
}

#[cfg(test)]
mod tests {
    use libration_report::record::Tolerance;

    use super::*;

    #[test]
    fn a_finding_that_disagrees_fails_the_run_and_is_named() {
        let record = |measured: f64| {
            let mut record = Record::new("drift", "?");
            let tolerance = Tolerance::absolute(1e-6, "rounding");
            let finding =
                Finding::predicted("drift.rk4", "drift of RK4", "J", 1.0, measured, tolerance);
            record.find(finding);
            record
        };
        assert!(check_findings(&[record(1.0)]).is_ok());
        let wrong = record(2.0);
        let named = wrong.disagreements().map(disagreement).collect::<Vec<_>>();
        assert!(matches!(check_findings(&[wrong]), Err(Failure::Disagreement)));
        let expected = "the finding `drift.rk4` disagrees: predicted 1.0, measured 2.0, \
                        tolerance 1e-6, in units of J\n  drift of RK4";
        assert_eq!(named, [expected]);
    }
}
