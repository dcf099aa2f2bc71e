//! `libration simulate --adaptive`.

use assert_cmd::Command;
use predicates::prelude::PredicateBooleanExt;
use predicates::str::contains;

fn libration(words: &str) -> assert_cmd::assert::Assert {
    Command::cargo_bin("libration").unwrap().args(words.split_whitespace()).assert()
}

/// The numbers of the rows.
fn rows(words: &str) -> (String, Vec<Vec<f64>>) {
    let output = libration(words).success();
    let text = String::from_utf8(output.get_output().stdout.clone()).unwrap();
    let (head, rows) = text.split_once('\n').unwrap();
    let rows = rows.lines().map(|row| row.split(',').map(|x| x.parse().unwrap()).collect());
    (head.to_owned(), rows.collect())
}

#[test]
fn steps_follow_the_distance_and_the_energy_stays() {
    let (head, rows) = rows(
        "simulate --system kepler --q 0.1,0 --v 0,4.358898943540674 --integrator leapfrog --dt 0.001 \
         --steps 20000 --adaptive integrating",
    );
    assert_eq!(head, "step,t,dt,x,y,x',y',energy");
    for pair in rows.windows(2).skip(1) {
        let ([.., energy], [_, before, ..]) = (&pair[1][..], &pair[0][..]) else { panic!() };
        assert!((energy + 0.5).abs() < 5e-3, "{energy}");
        // The length is the difference of the times.
        assert!((pair[1][1] - before - pair[1][2]).abs() < 1e-9);
    }
    let lengths = rows.iter().skip(1).map(|row| row[2]);
    let (least, most) = lengths.fold((f64::MAX, 0.0_f64), |(a, b), x| (a.min(x), b.max(x)));
    // From 0.1 to 1.9: a ratio of 19^(3/2) = 83.
    assert!((70.0..95.0).contains(&(most / least)), "{most} {least}");
}

#[test]
fn systems_by_equations_have_adaptive_steps_and_notes_where_they_are_not_reversible() {
    libration("simulate --force -4*q0-q0^3 --integrator yoshida4 --dt 0.1 --steps 10 --adaptive symmetric")
        .success()
        .stderr("");
    libration("simulate --force -4*q0-0.1*v0-q0^3 --integrator leapfrog --dt 0.1 --steps 10 --adaptive symmetric")
        .success()
        .stderr(contains("not reversible").and(contains("velocit")));
    libration(
        "simulate --force -4*q0-q0^3 --integrator rk4 --dt 0.1 --steps 10 --adaptive integrating",
    )
    .success()
    .stderr(contains("rk4 is not symmetric"));
}

#[test]
fn times_have_the_unit_of_the_equations() {
    for (system, unit) in [("kepler", "s"), ("henon-heiles", "1")] {
        let words = format!(
            "simulate --system {system} --integrator leapfrog --dt 0.1 --steps 2 --adaptive naive --format json"
        );
        let output = libration(&words).success().get_output().stdout.clone();
        let found: serde_json::Value = serde_json::from_slice(&output).unwrap();
        assert_eq!(found["columns"].as_array().unwrap()[1..3], ["t", "dt"]);
        assert_eq!(found["units"].as_array().unwrap()[1..3], [unit, unit], "{system}");
    }
}

#[test]
fn wrong_adaptive_steps_are_usage_errors() {
    let fails = |words: &str, what: &str| {
        libration(words).failure().code(2).stderr(contains(what));
    };
    let base = "simulate --system kepler --integrator leapfrog --dt 0.1 --steps 9 --adaptive";
    fails(&format!("{base} exact"), "integrating");
    fails(&format!("{base} naive --dtype f32"), "f64 only");
    fails(&format!("{base} naive --num-trajectories 3"), "cannot be used with");
    fails(
        "simulate --system pendulum --integrator trapezoid --dt 0.1 --steps 9 --adaptive naive",
        "requires an explicit integrator",
    );
    fails(
        "simulate --force 1 --integrator leapfrog --dt 0.1 --steps 9 --adaptive naive",
        "forces that change in space",
    );
}
