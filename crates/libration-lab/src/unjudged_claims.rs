//! Claims of the source report without a verdict in a run.

use libration_report::Record;
use libration_study::{Config, SourceClaim, Study, UnjudgedClaim};

use crate::STUDIES;

/// Returns the claims of all studies, each with the name of its study, sorted by number.
pub(crate) fn all_claims() -> Vec<(&'static SourceClaim, &'static str)> {
    let of = |study: &&'static dyn Study| {
        let name = study.name();
        study.source_claims().iter().map(move |claim| (claim, name))
    };
    let mut all: Vec<_> = STUDIES.studies.iter().flat_map(of).collect();
    all.sort_by_key(|(claim, _)| claim.order());
    all
}

/// Returns the claims without a verdict in the `records` of `studies`, with reasons.
pub fn unjudged(config: &Config, studies: &[&dyn Study], records: &[Record]) -> Vec<UnjudgedClaim> {
    let in_hand: Vec<&SourceClaim> =
        studies.iter().flat_map(|study| study.source_claims()).collect();
    let judged =
        |claim: &SourceClaim| records.iter().flat_map(|r| &r.claims).any(|c| c.id == claim.id);
    all_claims()
        .into_iter()
        .filter(|(claim, _)| !judged(claim))
        .map(|(claim, study)| {
            let missing = (!in_hand.contains(&claim)).then_some(study);
            let because = match missing {
                None => claim.reason_unjudged(config),
                Some(study) if records.iter().any(|r| r.name == study) => {
                    format!("its study, `{study}`, was run with other systems")
                }
                Some(study) => format!("its study, `{study}`, was not run"),
            };
            UnjudgedClaim { id: claim.id, because, missing }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::claims_without_study::CLAIMS_WITHOUT_STUDY;

    #[test]
    fn every_claim_is_accounted_for_once() {
        let mut wanted: BTreeSet<String> =
            (1..=91).chain([93, 95, 96]).map(|number| format!("C{number:02}")).collect();
        wanted.extend("C53a C58a C59a C59b C59c C65a C67a".split(' ').map(String::from));
        let claims = all_claims();
        let ids = claims
            .iter()
            .map(|(claim, _)| claim.id)
            .chain(CLAIMS_WITHOUT_STUDY.iter().map(|c| c.id));
        let found: Vec<String> = ids.map(String::from).collect();
        assert_eq!(found.len(), wanted.len());
        assert_eq!(found.into_iter().collect::<BTreeSet<_>>(), wanted);
    }
}
