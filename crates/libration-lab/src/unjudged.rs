//! Claims of the source report that a run leaves without a verdict.

use libration_report::Record;
use libration_study::{Config, Study, Tried, Unjudged};

use crate::STUDIES;

/// The claims that the studies of the laboratory try, each with its study, in the order of the ledger.
pub(crate) fn tried() -> Vec<(&'static Tried, &'static str)> {
    let of = |study: &&'static dyn Study| {
        let name = study.name();
        study.tries().iter().map(move |claim| (claim, name))
    };
    let mut all: Vec<_> = STUDIES.studies.iter().flat_map(of).collect();
    all.sort_by_key(|(claim, _)| claim.order());
    all
}

/// The claims that `records`, left by `studies`, do not judge, and why.
pub fn unjudged(config: &Config, studies: &[&dyn Study], records: &[Record]) -> Vec<Unjudged> {
    let in_hand: Vec<&Tried> = studies.iter().flat_map(|study| study.tries()).collect();
    let judged = |claim: &Tried| records.iter().flat_map(|r| &r.claims).any(|c| c.id == claim.id);
    tried()
        .into_iter()
        .filter(|(claim, _)| !judged(claim))
        .map(|(claim, study)| {
            let missing = (!in_hand.contains(&claim)).then_some(study);
            let because = match missing {
                None => claim.why_not(config),
                Some(study) if records.iter().any(|r| r.name == study) => {
                    format!("its study, `{study}`, was run on other systems")
                }
                Some(study) => format!("its study, `{study}`, was not run"),
            };
            Unjudged { id: claim.id, because, missing }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::untried::UNTRIED;

    #[test]
    fn every_claim_is_accounted_for_once() {
        let mut wanted: BTreeSet<String> =
            (1..=91).chain([93, 95, 96]).map(|number| format!("C{number:02}")).collect();
        wanted.extend("C53a C58a C59a C59b C59c C65a C67a".split(' ').map(String::from));
        let tried = tried();
        let ids = tried.iter().map(|(claim, _)| claim.id).chain(UNTRIED.iter().map(|c| c.id));
        let found: Vec<String> = ids.map(String::from).collect();
        assert_eq!(found.len(), wanted.len());
        assert_eq!(found.into_iter().collect::<BTreeSet<_>>(), wanted);
    }
}
