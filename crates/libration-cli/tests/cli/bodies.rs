//! `libration bodies`.

use std::fs;

use assert_cmd::Command;
use serde_json::Value;

fn libration(words: &str) -> assert_cmd::assert::Assert {
    Command::cargo_bin("libration").unwrap().args(words.split_whitespace()).assert()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn the_audit_of_bodies_has_a_prediction_for_each_change() {
    let words = "bodies figure-eight --integrator yoshida4 --dt 0.01 --steps 2e3 --json";
    let output = libration(words).success();
    let audit: Value = serde_json::from_slice(&output.get_output().stdout).unwrap();
    assert_eq!(audit["schema"], "libration.bodies/1");
    assert_eq!(audit["evaluations"], 3);
    let energy = &audit["conserved"][0];
    assert_eq!(energy["quantity"], "energy");
    let number = |key: &str| energy[key].as_f64().unwrap();
    let ratio = number("largest_change") / number("predicted_by_order");
    assert!((0.7..1.4).contains(&ratio), "{ratio}");
    assert!(number("predicted_by_rounding") < number("largest_change"));
    let keys: Vec<&str> = audit.as_object().unwrap().keys().map(String::as_str).collect();
    for key in ["system", "bodies", "integrator", "dt", "steps", "encounter", "stopped", "samples"]
    {
        assert!(keys.contains(&key), "{keys:?}");
    }
}

/// The first encounter of the Pythagorean problem is at 0.01 after 1.9; steps of 0.1 pass it in one, and throw the bodies out.
#[test]
fn a_motion_whose_energy_is_lost_has_a_fault_and_one_with_a_passed_encounter_is_unknown() {
    for (words, outcome, code) in [
        ("pythagorean --integrator velocity-verlet --dt 0.1 --steps 700", "fault", 1),
        ("figure-eight --integrator rk4 --dt 0.5 --steps 1000", "fault", 1),
        ("figure-eight --integrator explicit-euler --dt 5 --steps 1000", "fault", 1),
        ("figure-eight --integrator leapfrog --dt 0.15 --steps 30", "unknown", 1),
        // Jupiter's period of 4332.6 d has 10.8 steps.
        ("outer-solar-system --integrator velocity-verlet --dt 400 --steps 1000", "unknown", 1),
        ("outer-solar-system --integrator velocity-verlet --dt 100 --steps 1000", "no-fault", 0),
        ("figure-eight --integrator rk4 --dt 0.01 --steps 1000", "no-fault", 0),
    ] {
        let output = libration(&format!("bodies {words} --no-prediction --json")).code(code);
        let audit: Value = serde_json::from_slice(&output.get_output().stdout).unwrap();
        assert_eq!(audit["verdict"]["outcome"], outcome, "{words}: {}", audit["verdict"]);
    }
}

#[test]
fn near_a_parabolic_orbit_changes_are_relative_to_the_kinetic_energy() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("comet.csv");
    // Of two bodies with masses 1 and 1e-3 at a distance of 1 the relative speed √(2·1.001) makes the energy zero but for rounding.
    let size = |speed: f64| {
        let (heavy, light) = (-1e-3 * speed / 1.001, speed / 1.001);
        fs::write(
            &file,
            format!("mass,x,y,z,vx,vy,vz\n1,0,0,0,0,{heavy},0\n1e-3,1,0,0,0,{light},0\n"),
        )
        .unwrap();
        let words =
            format!("bodies {} --integrator yoshida4 --dt 0.001 --steps 1000", file.display());
        let output = libration(&format!("{words} --json")).success();
        let audit: Value = serde_json::from_slice(&output.get_output().stdout).unwrap();
        let energy = &audit["conserved"][0];
        let text = text(&libration(&words).success().get_output().stdout);
        (energy["size"].as_f64().unwrap(), energy["largest_change"].as_f64().unwrap(), text)
    };
    let parabolic = 2.002_f64.sqrt();
    for speed in [
        parabolic,
        parabolic * (1.0 + 1e-9),
        parabolic * (1.0 - 1e-9),
        1.01 * parabolic,
        0.98 * parabolic,
    ] {
        let (size, change, text) = size(speed);
        // ½·m₁m₂/(m₁ + m₂)·v².
        let kinetic = 0.5e-3 / 1.001 * speed * speed;
        assert!((size / kinetic - 1.0).abs() < 1e-12, "{speed}: {size} {kinetic}");
        // Yoshida's step of 1/1000 of the fastest motion: h⁴ and a factor of a few.
        assert!(change < 1e-10, "{speed}: {change}");
        assert!(text.contains("relative to the kinetic energy at the start"), "{text}");
    }
    // A circle has half of the potential energy, as before.
    let (size, _, text) = size(1.001_f64.sqrt());
    assert!(
        (size / 0.5e-3 - 1.0).abs() < 1e-12 && text.contains("relative to |E| = "),
        "{size} {text}"
    );
}

/// Two charges at rest at a distance of 1.
fn two_charges(folder: &std::path::Path) -> String {
    let file = folder.join("two.csv");
    let rows = "mass,x,y,z,vx,vy,vz,charge\n1,0,0,0,0,0,0,1\n2,1,0,0,0,0.5,0,-1\n";
    fs::write(&file, rows).unwrap();
    file.display().to_string()
}

fn with_potential(file: &str, potential: &str) -> assert_cmd::assert::Assert {
    let mut command = Command::cargo_bin("libration").unwrap();
    let words = format!("bodies {file} --integrator leapfrog --dt 0.01 --steps 300 --json");
    command.args(words.split_whitespace()).args(["--pair-potential", potential]).assert()
}

#[test]
fn a_pair_potential_on_the_command_line_moves_charges() {
    let folder = tempfile::tempdir().unwrap();
    let output = with_potential(&two_charges(folder.path()), "q1*q2/r").success();
    let audit: Value = serde_json::from_slice(&output.get_output().stdout).unwrap();
    assert_eq!(
        (&audit["gravitational_constant"], &audit["pair_potential"]),
        (&0.0.into(), &"q1*q2/r".into())
    );
    // The kinetic energy of a mass of 2 at a speed of 0.5, less 1.
    assert!((audit["energy"].as_f64().unwrap() + 0.75).abs() < 1e-12, "{audit}");
}

#[test]
fn potentials_that_are_wrong_or_not_finite_are_refused_or_end_the_motion() {
    let folder = tempfile::tempdir().unwrap();
    let file = two_charges(folder.path());
    for (potential, message) in [
        ("q1*q2/d", "unknown name `d`; the names are"),
        ("q1*q2", "it does not depend on `r`"),
        ("log(-r)", "the energy is not finite at t = 0.0"),
        ("1/(r-1)", "the energy is not finite at t = 0.0"),
    ] {
        let failed = with_potential(&file, potential).code(2);
        let said = text(&failed.get_output().stderr);
        assert!(said.contains(message), "{potential}: {said}");
    }
    // Fine at the start.
    let failed = with_potential(&file, "if(r < 0.9, log(-r), -1/r)").code(1);
    let output = failed.get_output();
    assert!(text(&output.stderr).contains("the energy is not finite at t = "), "{output:?}");
    let audit: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(audit["stopped"].as_str().unwrap().contains("not finite"), "{audit}");
}

#[test]
fn rows_have_each_body_of_each_sample() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("orbit.csv");
    let words = format!(
        "bodies pythagorean --integrator leapfrog --dt 0.001 --steps 100 --save-every 25 --output {}",
        file.display()
    );
    libration(&words).success();
    let rows = fs::read_to_string(&file).unwrap();
    let lines: Vec<&str> = rows.lines().collect();
    assert_eq!(lines[0], "body,step,t,x,y,z,vx,vy,vz");
    assert_eq!(lines.len(), 1 + 5 * 3);
    assert!(lines[4].starts_with("0,25,0.025,"), "{}", lines[4]);
}

#[test]
fn a_collision_fails_the_run_and_keeps_its_rows() {
    let folder = tempfile::tempdir().unwrap();
    let (bodies, rows) = (folder.path().join("two.toml"), folder.path().join("rows.csv"));
    let body = |name: &str, x: f64| {
        format!(
            "[[body]]\nname = \"{name}\"\nmass = 1\nposition = [{x}, 0, 0]\nvelocity = [0, 0, 0]\nradius = 0.1\n"
        )
    };
    fs::write(&bodies, body("left", 0.0) + &body("right", 1.0)).unwrap();
    let words = format!(
        "bodies {} --integrator leapfrog --dt 0.01 --steps 1e3 --save-every 10 --output {}",
        bodies.display(),
        rows.display()
    );
    let failed = libration(&words).code(1);
    let message = text(&failed.get_output().stderr);
    assert!(message.contains("`left` and `right` collide at t = 0.7"), "{message}");
    assert!(fs::read_to_string(&rows).unwrap().lines().count() > 10);
}

#[test]
fn wrong_bodies_are_usage_errors() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("bad.csv");
    fs::write(&file, "mass,x,y,z,vx,vy,vz\n1,0,0,0,0,0,x\n").unwrap();
    let file = file.display().to_string();
    let of_file = format!("bodies {file} --integrator leapfrog --dt 0.1 --steps 1");
    for (words, message) in [
        (
            "bodies figure-eigth --integrator leapfrog --dt 0.1 --steps 1",
            "did you mean `figure-eight`",
        ),
        ("bodies figure-eight --integrator leap --dt 0.1 --steps 1", "did you mean `leapfrog`"),
        ("bodies plummer --integrator leapfrog --dt 0.1 --steps 1", "plummer requires --count"),
        (
            "bodies kozai --count 3 --integrator leapfrog --dt 0.1 --steps 1",
            "--count applies to plummer",
        ),
        ("bodies kozai --softening -1 --integrator leapfrog --dt 0.1 --steps 1", "(--softening)"),
        (
            "bodies figure-eight --softening 1 --integrator wisdom-holman --dt 0.1 --steps 1",
            "without softening",
        ),
        ("bodies figure-eight --integrator leapfrog --dt -1 --steps 1", "--dt"),
        ("bodies missing.csv --integrator leapfrog --dt 1 --steps 1", "cannot read `missing.csv`"),
        (of_file.as_str(), "vz = `x`; expected a number"),
    ] {
        let failed = libration(words).code(2);
        let error = text(&failed.get_output().stderr);
        assert!(error.contains(message), "{words}: {error}");
    }
}
