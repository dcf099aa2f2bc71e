//! The studies of rollouts: what they are to tell is there. How fast a machine is, no test asks.

use libration_report::Record;
use libration_report::record::Agreement;

use crate::default_run::{measured, predicted, records};

fn record() -> &'static Record {
    records().iter().find(|record| record.name == "rollout").unwrap()
}

#[test]
fn every_wanted_share_of_a_fill_that_a_quick_run_can_measure_is_a_finding() {
    for id in ["4096x1024", "1024x512", "512x64", "256x16", "rate.4096x1024", "advantages"] {
        let share = measured(&format!("rollout.{id}"));
        assert!(share.is_finite() && share > 0.0, "{id}: {share}");
    }
    let refused = &record().table("not timed").unwrap().rows;
    assert!(refused.iter().any(|row| row[1].value() == Some(16_384.0)), "{refused:?}");
}

#[cfg(debug_assertions)]
#[test]
fn a_build_that_is_not_for_speed_is_judged_by_counts_and_by_the_source_alone() {
    let judged = record().findings.iter().filter(|f| f.verdict != Agreement::Measured);
    let kinds = ["kept", "broken", "stride", "faults", "source"];
    for finding in judged {
        let kind = finding.id.split('.').nth(1).unwrap();
        assert!(kinds.contains(&kind), "{}", finding.id);
    }
}

#[test]
fn the_larger_example_of_the_source_is_17_bytes_a_transition_held_as_planned() {
    // 16384 × 2048 × 17.
    assert_eq!(predicted("memory.16384x2048"), 570_425_344.0);
    assert_eq!(measured("memory.16384x2048"), 570_425_344.0);
    assert_eq!(measured("memory.256x512.held"), 2_228_224.0);
    // Two floats, a reward and a flag.
    assert_eq!(measured("memory.listed"), 13.0);
}
