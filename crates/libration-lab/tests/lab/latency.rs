//! The study of latency, beside numbers from elsewhere.

use crate::default_run::{measured, predicted, records};

#[track_caller]
fn close(id: &str, want: f64, tolerance: f64) {
    for got in [predicted(id), measured(id)] {
        assert!((got / want - 1.0).abs() <= tolerance, "{id}: {got}, not {want}");
    }
}

#[test]
fn a_late_force_grows_as_an_independent_program_has_it() {
    // To 0.1 %, over a million steps rather than from the hundredth on.
    close("latency.force-1.long", 148.4, 1e-3);
    assert_eq!(measured("latency.force-1.explicit-euler"), 0.0);
}

#[test]
fn critical_latencies_are_those_of_a_calculation_in_fifty_digits() {
    let record = records().iter().find(|r| r.name == "latency").unwrap();
    let rows = &record.table("critical latencies").unwrap().rows;
    // Of whole steps, by the polynomial with any power; and the continuous margin.
    for (row, want) in
        rows.iter().zip([15.5526357323289, 15.3230231432745, 15.3248412410345, 15.3248410960922])
    {
        assert!((row[1].value().unwrap() - want).abs() < 1e-12, "{row:?}");
        assert!((row[5].value().unwrap() - 0.158235684716435).abs() < 1e-14);
    }
    // Of any part, in exact steps 15.3234267109; RK4 is as near as its order has it.
    close("latency.onset.rk4", 15.3234267109, 1e-6);
}

#[test]
fn a_loop_is_stable_again_from_174_to_211_steps() {
    for (id, want) in [("1-to", 41.0), ("2-from", 174.0), ("2-to", 211.0)] {
        close(&format!("latency.windows.{id}"), want, 0.0);
    }
}

#[test]
fn the_same_latencies_are_stable_or_not_by_their_memory() {
    let record = records().iter().find(|r| r.name == "latency").unwrap();
    let rows = &record.table("random latency").unwrap().rows;
    let exact: Vec<_> = rows.iter().filter(|row| row[0] == "exact steps".into()).collect();
    for (row, want) in exact.iter().zip([0.995086647407, 1.015545489573]) {
        assert!((row[2].value().unwrap() - want).abs() < 1e-11, "{row:?}");
    }
    for method in ["velocity-verlet", "rk4"] {
        let radius = |hold: &str| predicted(&format!("latency.random.{method}.hold-{hold}.radius"));
        assert!(radius("0") < 1.0 && radius("0.5") > 1.0, "{method}");
    }
}
