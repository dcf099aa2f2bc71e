//! Verdicts of `libration bodies` on orbits and bodies that are too many to have energies of their own.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use serde_json::Value;

use super::bodies_verdicts::{assert_outcome, audit, file};

const HEAD: &str = "name,mass,x,y,z,vx,vy,vz";

/// A ball of equal masses with a sum of 1, on a spiral. Velocities are those of a slow turn.
fn ball(count: usize) -> Vec<String> {
    let row = |k: usize| {
        let part = (k as f64 + 0.5) / count as f64;
        let (radius, height) = (1.5 * part.cbrt(), 1.0 - 2.0 * part);
        let (ring, angle) = ((1.0 - height * height).sqrt(), 2.399_963 * k as f64);
        let [x, y] = [angle.cos(), angle.sin()].map(|x| radius * ring * x);
        let mass = 1.0 / count as f64;
        format!("s{k},{mass},{x},{y},{},{},{},0", radius * height, -0.4 * y, 0.4 * x)
    };
    [HEAD.to_owned()].into_iter().chain((0..count).map(row)).collect()
}

/// Two bodies on circles at the distance `axis` of each other, far from the rest, and the energy of their orbit.
fn pair(names: [&str; 2], masses: [f64; 2], axis: f64, far: f64) -> (String, f64) {
    let sum = masses[0] + masses[1];
    let speed = (sum / axis).sqrt();
    let mut rows = String::new();
    for (i, sign) in [(0, 1.0), (1, -1.0)] {
        let part = sign * masses[1 - i] / sum;
        let (mass, x) = (masses[i], far + part * axis);
        let _ = writeln!(rows, "{},{mass},{x},0,0,0,{},0", names[i], part * speed);
    }
    (rows.trim_end().to_owned(), masses[0] * masses[1] / (2.0 * axis))
}

fn written(folder: &Path, name: &str, rows: &[String]) -> String {
    let rows: Vec<&str> = rows.iter().map(String::as_str).collect();
    file(folder, name, &rows)
}

/// The energy of the orbit of the last two bodies in the last sample of a file, per reduced mass.
fn last_orbit(rows: &Path, mass: f64) -> f64 {
    let text = fs::read_to_string(rows).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let of = |line: &str| -> Vec<f64> {
        line.split(',').skip(3).map(|cell| cell.parse().unwrap()).collect()
    };
    let [one, other] = [lines[lines.len() - 2], lines[lines.len() - 1]].map(of);
    let square =
        |range: std::ops::Range<usize>| -> f64 { range.map(|k| (one[k] - other[k]).powi(2)).sum() };
    0.5 * square(3..6) - mass / square(0..3).sqrt()
}

/// The energy that a verdict states, relative to the size of all, is this one; three digits are printed.
fn assert_share(found: &Value, energy: f64) {
    let share = energy / found["conserved"][0]["size"].as_f64().unwrap();
    let (_, stated) =
        found["verdict"]["evidence"].as_str().unwrap().split_once("whose energy is ").unwrap();
    let stated: f64 = stated.split(' ').next().unwrap().parse().unwrap();
    assert!((stated / share - 1.0).abs() < 5e-3, "{stated} {share}");
}

#[test]
fn a_binary_that_dissolves_in_a_large_cluster_is_no_good_verdict() {
    let folder = tempfile::tempdir().unwrap();
    let rows_file = folder.path().join("rows.csv");
    let euler =
        |steps| format!("--integrator explicit-euler --dt 1e-5 --steps {steps} --save-every 500");
    for (masses, axis, steps) in [
        // Two equal masses, with 40 steps in an orbit; softer ones; a star and a planet.
        ([1e-3, 1e-3], 2e-4, 5000),
        ([1e-3, 1e-3], 1e-3, 3000),
        ([5e-3, 5e-4], 1e-3, 3000),
    ] {
        let (rows, energy) = pair(["a", "b"], masses, axis, 8.0);
        let mut all = ball(60);
        all.push(rows);
        let system = written(folder.path(), "pair.csv", &all);
        let words = euler(steps) + " --output " + rows_file.to_str().unwrap();
        let found = audit(&system, &words, None);
        assert_outcome(
            &found,
            "unknown",
            "the change may be that of the orbit of a and b, whose energy is 0.00",
        );
        // The orbit has lost more than a tenth of its energy −(m₁ + m₂)/2a; its share is that of the closed form.
        let sum = masses[0] + masses[1];
        assert!(last_orbit(&rows_file, sum) > -0.9 * sum / (2.0 * axis), "{masses:?} {axis}");
        assert_share(&found, energy);
        assert!(found["conserved"][0]["largest_change"].as_f64().unwrap() < 0.1, "{found}");
        // Leapfrog keeps it, and its change is far below.
        let words = "--integrator leapfrog --dt 1e-5 --steps 1000";
        assert_outcome(&audit(&system, words, None), "no-fault", "");
    }
}

#[test]
fn the_change_of_one_body_may_be_that_of_a_whole_one_among_many() {
    let folder = tempfile::tempdir().unwrap();
    // Beyond 2048 bodies the mean of the kinetic energies counts.
    let many = written(folder.path(), "many.csv", &ball(2100));
    let words = "--softening 0.05 --dt 0.02 --steps 20 --integrator";
    let found = audit(&many, &format!("{words} explicit-euler"), None);
    assert_outcome(&found, "unknown", "that of a single body, whose mean kinetic energy is 0.0");
    assert_outcome(&audit(&many, &format!("{words} leapfrog"), None), "no-fault", "");
    // Without orbits, the body with the least energy in the field of all others, which is smooth by a long softening length.
    let rows = ball(60);
    let some = written(folder.path(), "some.csv", &rows);
    let words = "--softening 0.5 --dt 0.02 --steps 200 --integrator";
    let found = audit(&some, &format!("{words} explicit-euler"), None);
    assert_outcome(&found, "unknown", " alone, whose energy is 0.0");
    let numbers: Vec<Vec<f64>> = rows[1..]
        .iter()
        .map(|row| row.split(',').skip(1).map(|cell| cell.parse().unwrap()).collect())
        .collect();
    let energy = |own: &Vec<f64>| {
        let square = |other: &Vec<f64>| (1..4).map(|k| (own[k] - other[k]).powi(2)).sum::<f64>();
        let others = numbers.iter().filter(|other| square(other) > 0.0);
        let potential: f64 = others.map(|other| -other[0] / (square(other) + 0.25).sqrt()).sum();
        let kinetic = 0.5 * (4..7).map(|k| own[k] * own[k]).sum::<f64>();
        own[0] * (kinetic + potential).abs()
    };
    let least = numbers.iter().map(energy).fold(f64::INFINITY, f64::min);
    assert_share(&found, least);
    assert_outcome(&audit(&some, &format!("{words} leapfrog"), None), "no-fault", "");
}

#[test]
fn the_change_in_a_pair_potential_may_be_that_of_one_of_many_atoms() {
    let folder = tempfile::tempdir().unwrap();
    let mut rows = vec![HEAD.to_owned()];
    for k in 0..27 {
        let [i, j, l] = [k % 3, k / 3 % 3, k / 9].map(|n| 1.122_462 * f64::from(n));
        let [u, v, w] = [1.0, 2.0, 3.0].map(|n: f64| 0.5 * (n * f64::from(k)).sin());
        rows.push(format!("a{k},1,{i},{j},{l},{u},{v},{w}"));
    }
    let system = written(folder.path(), "atoms.csv", &rows);
    let potential = Some("4*(r^-12 - r^-6)");
    let found = audit(&system, "--integrator explicit-euler --dt 3e-4 --steps 5000", potential);
    assert_outcome(&found, "unknown", "that of a single body, whose mean kinetic energy is 0.0");
    let words = "--integrator leapfrog --dt 0.003 --steps 300";
    assert_outcome(&audit(&system, words, potential), "no-fault", "");
}
