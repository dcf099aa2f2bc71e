//! `libration simulate` of linear plants and loops around them, through the binary.

use std::fs;

use predicates::prelude::*;
use serde_json::Value;

use super::advise::libration;

/// Two modes, 2 rad/s with damping and a lag of 0.5 s, with a comma in a name.
const PLANT: &str = "\
a = [[0, 1, 0], [-4, -0.4, 0], [0, 0, -2]]
b = [[0, 0], [1, 0], [0, 1]]
states = [\"angle (rad)\", \"rate (rad/s)\", \"oil, warm (K)\"]
inputs = [\"torque (N m)\", \"heat (W)\"]
";

/// The command line with a file of the plant in place of `PLANT`, and its output.
fn csv(options: &str) -> Vec<String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("plant.toml");
    fs::write(&path, PLANT).unwrap();
    let words = ["simulate", "--plant", path.to_str().unwrap()];
    let words: Vec<&str> = words.into_iter().chain(options.split_whitespace()).collect();
    let output = libration(&words).success().get_output().stdout.clone();
    String::from_utf8(output).unwrap().lines().map(str::to_owned).collect()
}

#[test]
fn a_step_of_an_input_in_open_loop_is_the_step_response() {
    let rows = csv("--steps 40 --period 0.05 --disturbance heat=3 --x0 0.1,0,0");
    assert_eq!(
        rows[0],
        "step,t,angle,rate,\"oil, warm\",measured angle,measured rate,\"measured oil, warm\",input torque,input heat,cost"
    );
    assert_eq!(rows.len(), 42);
    for (k, row) in rows[1..].iter().enumerate() {
        let x: Vec<f64> = row.split(',').map(|x| x.parse().unwrap()).collect();
        let t = 0.05 * k as f64;
        assert_eq!(x[0], k as f64);
        // A mode of 2 rad/s with a damping of 0.1, and 3/2·(1 − e⁻²ᵗ).
        let omega = (4.0_f64 - 0.04).sqrt();
        let (sine, cosine) = (omega * t).sin_cos();
        let angle = 0.1 * (-0.2 * t).exp() * (cosine + 0.2 / omega * sine);
        let warm = 1.5 * (1.0 - (-2.0 * t).exp());
        for (found, wanted) in [(x[1], t), (x[2], angle), (x[4], warm), (x[9], 3.0)] {
            // Forty steps with some roundings each.
            assert!((found - wanted).abs() < 1e-13, "{k}: {found} {wanted}");
        }
    }
}

#[test]
fn the_rows_of_a_loop_do_not_depend_on_the_number_of_loops_and_threads() {
    let options = "--lqr 10,1,1/0.1,1 --period 0.05 --latency 0.03 --output-latency 0.01,0,0.07 \
                   --jitter gaussian:0.1 --loss 0.1 --noise --seed 3 --x0 1,0,0 --steps 50 --save-every 10";
    let one = csv(options);
    for more in [
        "--num-trajectories 40",
        "--num-trajectories 40 --threads 2",
        "--num-trajectories 3 --simd baseline",
    ] {
        let all = csv(&format!("{options} {more}"));
        let first: Vec<&str> = all.iter().filter_map(|row| row.strip_prefix("0,")).collect();
        assert_eq!(first, one[1..], "{more}");
    }
}

#[test]
fn wrong_options_of_a_plant_are_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("plant.toml");
    fs::write(&path, PLANT).unwrap();
    for (options, message) in [
        ("--disturbance heet=1", "unknown input `heet` (--disturbance): did you mean `heat`"),
        ("--x0 1,2", "--x0 is 2 numbers; expected 3 numbers, one for each of the states"),
        ("--latency 1e9steps", "--latency: "),
        ("--reference temperature=1", "--reference is given, but no controller reads"),
        ("--latency 0.3", "--latency is given, but no controller reads"),
        ("--loss 0.5", "--loss is given, but no controller reads"),
        ("--dt 0.01", "cannot be used with"),
        ("--skew gaussian:0.1", "cannot be used with"),
    ] {
        let words = ["simulate", "--steps", "5", "--plant", path.to_str().unwrap()];
        let words: Vec<&str> = words.into_iter().chain(options.split_whitespace()).collect();
        libration(&words).code(2).stderr(predicate::str::contains(message));
    }
}

#[test]
fn a_file_without_a_controller_is_simulated_in_open_loop_and_json_has_names_and_units() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("loop.toml");
    fs::write(&path, "[system.linear]\na = [[0]]\nb = [[1]]\nstates = [\"way (m)\"]\n").unwrap();
    let path = path.to_str().unwrap();
    let options = ["--steps", "2", "--disturbance", "u1=2", "--format", "json"];
    let words = [&["simulate", "--config", path], &options[..]].concat();
    let output = libration(&words).success().get_output().stdout.clone();
    let found: Value = serde_json::from_slice(&output).unwrap();
    assert_eq!(found["columns"][2], "way");
    assert_eq!(found["units"][2], "m");
    assert_eq!(found["rows"][2][2], 0.04);
}

#[test]
fn a_system_of_the_catalogue_refuses_the_options_of_linear_plants() {
    let words = [
        "simulate",
        "--system",
        "oscillator",
        "--integrator",
        "rk4",
        "--dt",
        "0.1",
        "--steps",
        "2",
    ];
    let own = ["--lqr 1/1", "--gain 1,1", "--period 0.1", "--loss 0.1"];
    let own = own.map(|option| (option, "there is no loop around a plant"));
    let others = ["--x0 1,0", "--noise"].map(|option| (option, "cannot be used with"));
    for (option, why) in own.into_iter().chain(others) {
        let option: Vec<&str> = option.split_whitespace().collect();
        libration(&[&words[..], &option].concat())
            .code(2)
            .stdout("")
            .stderr(predicate::str::contains(why));
    }
}
