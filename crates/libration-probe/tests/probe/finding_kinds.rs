//! The kinds of findings.

use libration_probe::FindingKind;

#[test]
fn every_kind_is_in_the_documentation() {
    let docs = include_str!("../../../../docs/probe.md");
    for kind in FindingKind::ALL {
        assert!(docs.contains(&format!("`{kind}`")), "{kind} is not in docs/probe.md");
    }
}
