//! Claims of two runs, compared.

use std::collections::HashMap;

use libration_report::record::{Claim, ClaimVerdict};
use serde::Serialize;

/// A claim whose verdict, condition or findings differ, or that one run alone has.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClaimChange {
    /// Its number in the ledger.
    pub id: String,
    /// The verdict of the first run; none if it has none.
    pub before: Option<ClaimVerdict>,
    /// The verdict of the second run; none if it has none.
    pub after: Option<ClaimVerdict>,
    /// Whether it was certain, and the second run, which should have it, has another or none.
    pub is_lost: bool,
}

/// The claims that one run alone has or judges otherwise.
///
/// Each claim comes with the name of its study, of which `should_have` says whether the second run should have it.
pub(crate) fn claim_changes<'a>(
    before: impl Iterator<Item = (&'a str, &'a Claim)> + Clone,
    after: impl Iterator<Item = (&'a str, &'a Claim)> + Clone,
    should_have: impl Fn(&str) -> bool,
) -> Vec<ClaimChange> {
    let old: HashMap<&str, &Claim> =
        before.clone().map(|(_, claim)| (claim.id.as_str(), claim)).collect();
    let new: HashMap<&str, &Claim> =
        after.clone().map(|(_, claim)| (claim.id.as_str(), claim)).collect();
    let is_certain = |verdict| !matches!(verdict, ClaimVerdict::Undecided);
    let changed = before.filter_map(|(study, claim)| {
        let second = new.get(claim.id.as_str()).map(|claim| claim.verdict);
        let is_lost = is_certain(claim.verdict)
            && match second {
                // A certain verdict that another one contradicts, under the same settings.
                Some(_) => true,
                None => should_have(study),
            };
        let (id, first) = (claim.id.clone(), Some(claim.verdict));
        let is_other = new
            .get(claim.id.as_str())
            .is_some_and(|new| new.condition != claim.condition || new.findings != claim.findings);
        (second != first || is_other).then_some(ClaimChange {
            id,
            before: first,
            after: second,
            is_lost,
        })
    });
    let added = after.filter(|(_, claim)| !old.contains_key(claim.id.as_str()));
    let added = added.map(|(_, claim)| ClaimChange {
        id: claim.id.clone(),
        before: None,
        after: Some(claim.verdict),
        is_lost: false,
    });
    changed.chain(added).collect()
}
