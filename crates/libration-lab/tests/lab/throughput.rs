//! The study of speed: what it measures is there, and what it says of itself is true. How fast a machine
//! is, no test asks.

use std::sync::atomic::AtomicBool;

use libration_lab::STUDIES;
use libration_report::Record;
use libration_report::record::Agreement;
use libration_study::{Effort, Lab, Silent};
use libration_study_batch::bench::{BenchFloat, Implementation};
use libration_study_batch::{Wanted, ladder};

use crate::default_run::{measured, records};

fn record() -> &'static Record {
    records().iter().find(|record| record.name == "throughput").unwrap()
}

#[test]
fn every_row_of_the_table_of_bars_is_a_finding() {
    for id in [
        "symplectic-euler.f32",
        "symplectic-euler.f64",
        "velocity-verlet.f32",
        "velocity-verlet.f64",
        "rk4.f32",
        "rk4.f64",
        "one.symplectic-euler.f32",
        "one-step.1e6",
        "sine",
        "sine.share",
        "roofline",
        "best.fused",
        "bandwidth.stream",
        "bandwidth.update",
        "faults.fresh",
    ] {
        let finding = record().finding(&format!("throughput.{id}")).unwrap();
        assert!(finding.measured.is_finite() && finding.measured > 0.0, "{id}");
    }
}

#[cfg(debug_assertions)]
#[test]
fn a_build_that_is_not_for_speed_is_not_judged_by_it() {
    // The count of page faults is no speed.
    let judged = record().findings.iter().filter(|f| f.verdict != Agreement::Measured);
    let judged: Vec<_> = judged.map(|f| f.id.as_str()).collect();
    assert_eq!(judged, ["throughput.faults.fresh"]);
}

#[test]
fn array_operations_access_three_times_what_the_formula_of_the_source_counts() {
    // a = −ω²x, Δt·a and Δt·v read one array and write one, v + Δt·a and x + Δt·v read two.
    assert_eq!(measured("throughput.arrays.in-place"), (3.0 * 2.0 + 2.0 * 3.0) / 4.0);
    assert_eq!(measured("throughput.arrays.one-step"), 1.0);
}

#[test]
fn every_implementation_has_a_curve_in_both_floats_and_every_curve_its_regimes() {
    let regimes = &record().table("regimes").unwrap().rows;
    for implementation in Implementation::ALL {
        for float in BenchFloat::ALL {
            let name = format!("scaling-{}-{}", implementation.name(), float.name());
            let series = record().series(&name).unwrap();
            let counts = series.column("trajectories").unwrap();
            assert!(counts.len() >= 6 && counts[0] == 1.0, "{name}: {counts:?}");
            let rates = series.column("steps_per_second").unwrap();
            assert!(rates.iter().all(|&rate| rate > 0.0), "{name}: {rates:?}");
            let own: Vec<_> = regimes
                .iter()
                .filter(|row| {
                    row[0] == implementation.title().into() && row[1] == float.name().into()
                })
                .collect();
            let ends =
                own.first().map(|row| row[2].value()).zip(own.last().map(|row| row[3].value()));
            assert_eq!(ends, Some((Some(1.0), counts.last().copied())), "{name}");
        }
    }
}

#[test]
fn what_is_wanted_is_timed_in_its_order() {
    let (config, stop) = (STUDIES.config(), AtomicBool::new(false));
    let lab = Lab::new(&config, Effort::Quick, &Silent, &stop);
    let of = |implementation, count| Wanted { implementation, float: BenchFloat::F64, count };
    let wanted = [of(Implementation::Fused, 100), of(Implementation::InPlace, 7)];
    let rates = ladder(&lab, &wanted).unwrap();
    let timed = rates.iter().map(|r| (r.implementation, r.count)).collect::<Vec<_>>();
    assert_eq!(timed, wanted.map(|w| (w.implementation, w.count)));
    assert!(rates.iter().all(|rate| rate.median > 0.0 && rate.spread >= 0.0));
}

#[test]
fn more_trajectories_than_the_memory_holds_are_refused_with_figures() {
    let far = Wanted {
        implementation: Implementation::InPlace,
        float: BenchFloat::F64,
        count: usize::MAX / 64,
    };
    let refused = far.check().unwrap_err().to_string();
    assert!(refused.contains("GB of memory are needed"), "{refused}");
}
