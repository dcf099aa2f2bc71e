//! Verdicts of `libration bodies`: light bodies, fast orbits, pair potentials and passes within a step.
//!
//! long: all kinds share how an audit is taken and compared.

use std::fs;
use std::path::Path;

use assert_cmd::Command;
use serde_json::Value;

const HEAD: &str = "name,mass,x,y,z,vx,vy,vz";

pub(super) fn file(folder: &Path, name: &str, rows: &[&str]) -> String {
    let path = folder.join(name);
    fs::write(&path, rows.join("\n") + "\n").unwrap();
    path.display().to_string()
}

/// The audit of `libration bodies`, whose exit code must be that of its verdict.
pub(super) fn audit(system: &str, words: &str, potential: Option<&str>) -> Value {
    let mut command = Command::cargo_bin("libration").unwrap();
    command.args(["bodies", system, "--json", "--no-prediction"]).args(words.split_whitespace());
    command.args(potential.map(|text| format!("--pair-potential={text}")));
    let output = command.output().unwrap();
    let audit: Value = serde_json::from_slice(&output.stdout).unwrap();
    let is_good = audit["verdict"]["outcome"] == "no-fault";
    assert_eq!(output.status.code(), Some(i32::from(!is_good)), "{audit}");
    audit
}

pub(super) fn assert_outcome(audit: &Value, outcome: &str, part: &str) {
    let verdict = &audit["verdict"];
    assert_eq!(verdict["outcome"], outcome, "{verdict}");
    assert!(verdict["evidence"].as_str().unwrap().contains(part), "{part}: {verdict}");
}

#[test]
fn a_massless_planet_that_leaves_its_orbit_is_a_fault() {
    let folder = tempfile::tempdir().unwrap();
    let sun = "sun,1,0,0,0,0,0,0";
    let planet = "p,0,1,0,0,0,1,0";
    for rows in [[HEAD, sun, planet], [HEAD, planet, sun]] {
        let system = file(folder.path(), "kepler.csv", &rows);
        let lost = audit(&system, "--integrator explicit-euler --dt 0.05 --steps 1000", None);
        assert_outcome(&lost, "fault", "the energy of the orbit of");
        // The sun is at rest: the planet alone by the same steps, its energy from -1/2.
        let (mut q, mut v, mut largest) = ([1.0_f64, 0.0], [0.0, 1.0_f64], 0.0_f64);
        for _ in 0..1000 {
            let cube = q[0].hypot(q[1]).powi(3);
            let force = q.map(|x| -x / cube);
            q = [q[0] + 0.05 * v[0], q[1] + 0.05 * v[1]];
            v = [v[0] + 0.05 * force[0], v[1] + 0.05 * force[1]];
            let kinetic = 0.5 * (v[0] * v[0] + v[1] * v[1]);
            let change = (kinetic - 1.0 / q[0].hypot(q[1]) + 0.5).abs();
            largest = largest.max(change / kinetic.max(0.5));
        }
        let own = lost["energies"][0]["largest_change"].as_f64().unwrap();
        // Rounding of 1000 steps, which the drift of the orbit makes larger by less than 1e4.
        assert!((own - largest).abs() < 1e-9 && largest > 0.5, "{own} {largest}");
        assert!(lost["energies"][0]["work_error"].as_f64().unwrap() < 1e-12);
        let kept = audit(&system, "--integrator leapfrog --dt 0.05 --steps 1000", None);
        assert_outcome(&kept, "no-fault", "of the orbit of");
    }
}

#[test]
fn light_bodies_that_heavier_ones_hide_have_energies_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    let (sun, jupiter) = ("sun,1,0,0,0,0,0,0", "jupiter,1e-3,5.2,0,0,0,0.43875,0");
    let earth = "earth,3e-6,1,0,0,0,1,0";
    for (name, rows, part, lossy, good) in [
        (
            "mercury",
            vec![sun, jupiter, "mercury,1e-8,0,0.39,0,-1.6,0,0"],
            "of sun and mercury",
            [0.005, 5e3],
            [0.005, 2e3],
        ),
        // The Moon, at a distance of 0.00257 with a relative speed of √(3.037e-6/0.00257).
        (
            "moon",
            vec![sun, earth, "moon,3.7e-8,1.00257,0,0,0,1.0343,0"],
            "of earth and moon",
            [0.001, 5e3],
            [0.001, 2e3],
        ),
        (
            "dust",
            vec![sun, earth, "dust,0,1.00257,0,0,0,1.0342,0"],
            "of earth and dust",
            [0.001, 5e3],
            [0.001, 2e3],
        ),
        // Faster than √(2/3.04) = 0.81: in no orbit.
        (
            "comet",
            vec![sun, jupiter, "comet,0,0.5,-3,0,0,1,0"],
            "of comet alone",
            [0.02, 1e3],
            [0.005, 3e3],
        ),
        // A centre of mass that moves, beside whose energy that of the orbit is small.
        (
            "moving",
            vec!["sun,1,0,0,0,1000,0,0", "p,1e-3,1,0,0,1000,1,0"],
            "0.605 of its size",
            [0.05, 1e3],
            [0.02, 1e3],
        ),
    ] {
        let rows: Vec<&str> = [HEAD].into_iter().chain(rows).collect();
        let system = file(folder.path(), &format!("{name}.csv"), &rows);
        let steps = |integrator: &str, [dt, steps]: [f64; 2]| {
            audit(&system, &format!("--integrator {integrator} --dt {dt} --steps {steps}"), None)
        };
        assert_outcome(&steps("explicit-euler", lossy), "fault", part);
        assert_outcome(&steps("leapfrog", good), "no-fault", "");
    }
}

#[test]
fn rounding_of_a_fast_centre_of_mass_is_no_fault() {
    let folder = tempfile::tempdir().unwrap();
    // The energy of the orbit is 5e-13, that of the centre of mass 5000, whose rounding is as large.
    let rows = [HEAD, "sun,1,0,0,0,100,0,0", "p,1e-12,1,0,0,100,1,0"];
    let system = file(folder.path(), "fast.csv", &rows);
    let kept = audit(&system, "--integrator yoshida4 --dt 0.05 --steps 2000", None);
    assert_outcome(&kept, "no-fault", "");
    // Yoshida's step of 1/125 of a circle: some (0.05)⁴.
    let change = kept["conserved"][0]["largest_change"].as_f64().unwrap();
    assert!(change < 1e-4, "{change}");
}

#[test]
fn a_light_body_among_too_many_is_unknown() {
    let folder = tempfile::tempdir().unwrap();
    let orbit = |k: usize, mass: f64| {
        let radius = 0.5 + 0.1 * k as f64;
        format!("a{k},{mass},{radius},0,0,0,{},0", radius.powf(-0.5))
    };
    let system = |name: &str, mass: f64| {
        let others: Vec<String> = (0..40).map(|k| orbit(k, mass)).collect();
        let rows: Vec<&str> = [HEAD, "sun,1,0,0,0,0,0,0"]
            .into_iter()
            .chain(others.iter().map(String::as_str))
            .collect();
        file(folder.path(), name, &rows)
    };
    let words = "--integrator explicit-euler --dt 0.01 --steps 500";
    // 41 pairs with a mass are looked at, 41² are not.
    assert_outcome(&audit(&system("massless.csv", 0.0), words, None), "fault", "of sun and a0");
    let words = "--integrator leapfrog --dt 0.01 --steps 100";
    let mut rows = fs::read_to_string(system("light.csv", 1e-6)).unwrap();
    rows += "dust,0,9,0,0,0,0.3333,0\n";
    let dusty = file(folder.path(), "dusty.csv", &[rows.trim_end()]);
    assert_outcome(&audit(&dusty, words, None), "unknown", "the energy of dust is too small");
}

#[test]
fn the_splitting_of_wisdom_and_holman_requires_twenty_kicks_in_the_shortest_orbit() {
    // Jupiter's circle of 5.19 au at the start: 4300 days.
    for (table, dt, outcome) in [
        ("", 5000, "unknown"),
        ("", 2000, "unknown"),
        ("", 400, "unknown"),
        ("", 200, "no-fault"),
        ("", 100, "no-fault"),
        (":saba-2", 1000, "unknown"),
        (":saba-4", 400, "no-fault"),
        (":aba-10-6-4", 800, "no-fault"),
    ] {
        let words = format!("--integrator wisdom-holman{table} --dt {dt} --steps 500");
        let part = if outcome == "unknown" { "sun and jupiter" } else { "" };
        let audit = audit("outer-solar-system", &words, None);
        if dt == 5000 {
            // Bodies that the steps throw together may decide first.
            assert_ne!(audit["verdict"]["outcome"], "no-fault", "{}", audit["verdict"]);
            continue;
        }
        assert_outcome(&audit, outcome, part);
    }
}

#[test]
fn a_constant_in_a_pair_potential_has_no_part_in_the_verdict() {
    let folder = tempfile::tempdir().unwrap();
    let system = file(folder.path(), "spring.csv", &[HEAD, "a,1,0,0,0,0,0,0", "b,1,1.1,0,0,0,0,0"]);
    for (words, outcome) in [
        ("--integrator rk4 --dt 1.9 --steps 1000", "fault"),
        ("--integrator leapfrog --dt 0.9 --steps 500", "fault"),
        ("--integrator explicit-euler --dt 0.02 --steps 1000", "fault"),
        ("--integrator rk4 --dt 0.05 --steps 1000", "no-fault"),
    ] {
        let change = |constant: &str| {
            let potential = format!("{constant}+0.5*(r-1)^2");
            let audit = audit(&system, words, Some(&potential));
            assert_outcome(&audit, outcome, "of what the motion exchanges");
            audit["conserved"][0]["largest_change"].as_f64().unwrap()
        };
        let plain = change("0");
        for constant in ["100", "-3e4", "1e6"] {
            // Rounding of a constant of 1e6 is 1e-10, of an exchange of 0.0025 or more.
            assert!((change(constant) - plain).abs() < 1e-6 * (1.0 + plain), "{words} {constant}");
        }
    }
}

#[test]
fn the_depth_of_a_well_hides_no_vibration_and_a_circle_is_no_fault() {
    let folder = tempfile::tempdir().unwrap();
    let pair = file(folder.path(), "pair.csv", &[HEAD, "a,1,0,0,0,0,0,0", "b,1,1.1325,0,0,0,0,0"]);
    let well = Some("4*(r^-12-r^-6)");
    let lost = audit(&pair, "--integrator rk4 --dt 0.16 --steps 500", well);
    assert_outcome(&lost, "fault", "of what the motion exchanges");
    let size = lost["conserved"][0]["size"].as_f64().unwrap();
    // From the start to the bottom of the well at 2^(1/6): 1 - 4 (r⁻⁶ - r⁻¹²), of which the first swing shows all but its samples.
    let sixth = 1.1325_f64.powi(-6);
    let depth = 1.0 + 4.0 * (sixth * sixth - sixth);
    assert!(size <= 1.1 * depth && size > 0.5 * depth, "{size} {depth}");
    let kept = audit(&pair, "--integrator leapfrog --dt 0.01 --steps 2000", well);
    assert_outcome(&kept, "no-fault", "");
    // A light dimer beside a heavy one, too far for forces: its own exchange is its scale.
    let head = "name,mass,x,y,z,vx,vy,vz,charge";
    let rows = [
        head,
        "a,1,0,0,0,0,0,0,2",
        "b,1,1.1,0,0,0,0,0,2",
        "c,1,99,0,0,0,0,0,1",
        "d,1,100.1,0,0,0,0,0,1",
    ];
    let dimers = file(folder.path(), "dimers.csv", &rows);
    let springs = "if(r < 50, if(q1*q2 > 2, 0.5, 5e-7)*(r-1)^2, 0)";
    // The heavy one has a frequency 1000 times as high: steps that keep it keep both.
    let kept = audit(&dimers, "--integrator leapfrog --dt 0.05 --steps 2000", Some(springs));
    assert_outcome(&kept, "no-fault", "");
    // A circle exchanges nothing.
    let rows = [head, "a,1,0,0,0,0,-0.5,0,1", "b,1,2,0,0,0,0.5,0,-1"];
    let circle = file(folder.path(), "circle.csv", &rows);
    let kept = audit(&circle, "--integrator rk4 --dt 0.05 --steps 2000", Some("q1*q2/r"));
    assert_outcome(&kept, "no-fault", "");
    let named = kept["verdict"]["not_examined"].to_string();
    assert!(named.contains("oscillations with a thousandth of the kinetic energy"), "{named}");
    assert_outcome(
        &audit("frozen-argon", "--integrator leapfrog --dt 4e-5 --steps 2000", None),
        "no-fault",
        "",
    );
}

#[test]
fn bodies_that_pass_through_each_other_within_a_step_are_unknown() {
    let folder = tempfile::tempdir().unwrap();
    let head = "name,mass,x,y,z,vx,vy,vz,radius";
    let system = |offset: f64, mass: f64, radius: f64| {
        let a = format!("a,{mass},-1,{offset},0,1,0,0,{radius}");
        let b = format!("b,{mass},1,0,0,-1,0,0,{radius}");
        file(folder.path(), "pass.csv", &[head, "c,1e-9,50,0,0,0,0,0,0", &a, &b])
    };
    for integrator in ["velocity-verlet", "rk4", "yoshida4"] {
        let words = format!("--integrator {integrator} --dt 0.3 --steps 10");
        for (offset, mass) in [(0.0, 1e-9), (0.005, 1e-9), (0.019, 0.0)] {
            let audit = audit(&system(offset, mass, 0.01), &words, None);
            assert_outcome(&audit, "unknown", "below the sum of their radii, between two steps");
            let encounter = &audit["encounter"];
            // Gravity of 2e-9 turns a pass at 0.005 with a speed of 2 by 2·2e-9/(4·0.005), and steps that are longer than it by more.
            let number = |key: &str| encounter[key].as_f64().unwrap();
            assert!((number("distance") - offset).abs() < 1e-5, "{encounter}");
            assert!((number("t") - 1.0).abs() < 1e-4, "{encounter}");
        }
        let audit = audit(&system(0.021, 1e-9, 0.01), &words, None);
        assert_outcome(&audit, "no-fault", "");
    }
    // Without radii, masses that pass within a step have an encounter with too few steps.
    let audit = audit(&system(0.0, 1e-6, 0.0), "--integrator leapfrog --dt 0.3 --steps 10", None);
    assert_outcome(&audit, "unknown", "an orbit at the distance of a and b");
}

#[test]
fn a_motion_below_the_rounding_of_its_energies_is_unknown_and_no_fault() {
    let folder = tempfile::tempdir().unwrap();
    // Three atoms at rest at their distance of rest, and a spring that a millionth of its length stretches.
    let rest = [
        HEAD,
        "a,1,0,0,0,0,0,0",
        "b,1,1.122462048309373,0,0,0,0,0",
        "c,1,0.5612310241546865,0.9720806486198328,0,0,0,0",
    ];
    let system = file(folder.path(), "rest.csv", &rest);
    let well = "4*(1/r^12 - 1/r^6)";
    let words = "--integrator leapfrog --dt 0.005 --steps 2000";
    assert_outcome(&audit(&system, words, Some(well)), "unknown", "are rounded by up to");
    let spring = [HEAD, "a,1,0,0,0,0,0,0", "b,1,1.000001,0,0,0,0,0"];
    let system = file(folder.path(), "spring.csv", &spring);
    let words = "--integrator leapfrog --dt 0.05 --steps 2000";
    for (constant, outcome) in [("", "no-fault"), (" + 1e3", "unknown"), (" + 1e9", "unknown")] {
        let found = audit(&system, words, Some(&format!("0.5*(r - 1)^2{constant}")));
        assert_outcome(&found, outcome, "");
    }
}

#[test]
fn encounters_of_many_bodies_are_named_as_looked_for_at_samples_only() {
    let folder = tempfile::tempdir().unwrap();
    let far: Vec<String> = (0..16).map(|i| format!("m{i},0,{},0,0,0,0,0", 1000 + i)).collect();
    let mut rows = vec![HEAD, "sun,1,0,0,0,0,0,0"];
    rows.extend(far.iter().map(String::as_str));
    let system = file(folder.path(), "many.csv", &rows);
    let found = audit(&system, "--integrator leapfrog --dt 0.01 --steps 10", None);
    let named = found["verdict"]["not_examined"].to_string();
    assert!(named.contains("encounters between samples"), "{found}");
}
