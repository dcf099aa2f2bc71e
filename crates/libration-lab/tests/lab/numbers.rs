//! Errors, stable steps and costs, beside numbers from elsewhere.

use std::collections::HashSet;

use libration_lab::claims_without_study::CLAIMS_WITHOUT_STUDY;
use libration_report::record::{Cell, Quantity};

use crate::default_run::{measured, predicted, records};

#[test]
fn the_numbers_of_the_source_are_met_as_it_compared_them_and_as_they_are() {
    // Printed by an independent program; the last digit may be one off.
    for (method, late, aligned) in [
        ("explicit-euler", 32.7323, 32.7323),
        ("symplectic-euler", 0.00382960, 0.00160666),
        ("velocity-verlet", 0.00271542, 0.000537979),
        ("rk4", 0.00223616, 1.07604e-9),
    ] {
        for (kind, want) in [("late", late), ("aligned", aligned)] {
            let got = measured(&format!("error.{method}.{kind}"));
            assert!((got / want - 1.0).abs() < 5e-6, "{method} {kind}: {got}, not {want}");
        }
    }
}

#[test]
fn stable_steps_are_those_of_an_independent_search() {
    let close = |id: &str, want: f64, tolerance: f64| {
        for got in [predicted(id), measured(id)] {
            assert!((got - want).abs() <= tolerance * want, "{id}: {got}, not {want}");
        }
    };
    // Six decimals were printed; RK4 from a brute-force search in NumPy.
    close("stability.velocity-verlet.drift-0.01.steps-10000", 0.2 / 10.0_f64.sqrt(), 1e-5);
    close("stability.symplectic-euler.drift-0.1.steps-1000", 0.057496, 1e-5);
    close("stability.rk4.drift-0.01.steps-10000", 0.064610, 1e-5);
    close("stability.rk4.drift-0.1.steps-1000", 0.140760, 1e-5);
    close("stability.rk4.amplitude.steps-10000", 0.894456, 1e-5);
    close("stability.crossover.drift-0.01", 11_363.0, 1e-4);
    close("stability.crossover.drift-0.1", 125.0, 0.01);
    // A scan of the trace in steps of 10⁻⁵ sees the ends of a gap of width 0.015.
    close("stability.uneven-thirds.window-1-to", 2.99228, 1e-5);
    close("stability.uneven-thirds.window-2-from", 3.00760, 1e-5);
    assert!(measured("stability.uneven-thirds.hasty") > 5.0);
    assert_eq!(predicted("stability.rk4.window-1-to"), 8.0_f64.sqrt());
}

#[test]
fn the_cheapest_method_is_the_one_that_a_hand_calculation_finds() {
    let record = records().iter().find(|r| r.name == "efficiency").unwrap();
    let rows = &record.table("answers").unwrap().rows;
    // SRKN6b: 7·2π/1.44028 = 30.5, the first root
    // of `|c/b + 1| = 10⁻⁴` for its product of shears with the rows `(a, b)` and `(c, a)`, in ten lines of NumPy.
    for periods in [1000_u64, 1_000_000] {
        let asked = ["energy".into(), 1e-4.into(), periods.into()];
        let row = rows.iter().find(|row| row[..3] == asked).unwrap();
        assert_eq!(row[3], "Blanes-Moan SRKN6b, order 4".into());
        let Cell::Number(Quantity::Real(z, _)) = row[4] else { panic!("{row:?}") };
        assert!((z - 1.440_280_964_6).abs() < 1e-9, "{z}");
    }
}

#[test]
fn an_oscillator_test_sees_order_four_where_the_word_says_three() {
    assert!((measured("convergence.lookalike.oscillator") - 4.0).abs() < 1e-3);
    assert!((measured("convergence.lookalike.pendulum") - 3.0).abs() < 1e-3);
}

#[test]
fn every_claim_of_the_chapters_on_stability_and_throughput_is_judged_or_accounted_for() {
    let judged = records().iter().flat_map(|r| &r.claims).map(|c| c.id.as_str());
    let claims_without_study = CLAIMS_WITHOUT_STUDY.iter().map(|u| u.id);
    let known: HashSet<&str> = judged.chain(claims_without_study).collect();
    let wanted = (1..=47).chain(68..=83).map(|n| format!("C{n:02}"));
    let missing: Vec<String> = wanted.filter(|id| !known.contains(id.as_str())).collect();
    assert!(missing.is_empty(), "{missing:?}");
}
