//! `libration analyze`, through the binary.

use assert_cmd::Command;
use serde_json::Value;

fn libration(words: &[&str]) -> assert_cmd::assert::Assert {
    Command::cargo_bin("libration").unwrap().args(words).assert()
}

fn json(words: &[&str]) -> Value {
    // An unstable step has exit code 1 and its numbers.
    let output = libration(&[words, &["--json"]].concat()).get_output().clone();
    assert!(matches!(output.status.code(), Some(0 | 1)), "{words:?}");
    let text = String::from_utf8(output.stdout).unwrap();
    // A drift beyond f64 is a valid JSON number that this reader refuses; its logarithm is tested.
    let fits = |line: &&str| {
        !line.contains("\"max_energy_drift\"") || {
            let number = line.rsplit(' ').next().unwrap().trim_end_matches(',');
            number.parse::<f64>().unwrap().is_finite()
        }
    };
    let kept: Vec<&str> = text.lines().filter(fits).collect();
    serde_json::from_str(&kept.join("\n")).unwrap()
}

/// A number of the oracle; beyond `f64` it reads as infinite.
fn number(value: &Value) -> f64 {
    value.as_str().map_or_else(|| value.as_f64().unwrap(), |text| text.parse().unwrap())
}

const NAMES: [(&str, &str); 5] = [
    ("explicit_euler", "explicit-euler"),
    ("semi_implicit_euler", "symplectic-euler"),
    ("semi_implicit_euler_drift_first", "symplectic-euler-drift-first"),
    ("velocity_verlet", "velocity-verlet"),
    ("rk4", "rk4"),
];

#[test]
fn every_case_of_the_oracle_is_met_to_12_digits() {
    let oracle = include_str!("../../../libration/tests/reference/oracle.json");
    let oracle: Value = serde_json::from_str(oracle).unwrap();
    for case in oracle["cases"].as_array().unwrap() {
        let (w2, dt) = (number(&case["w2"]), number(&case["dt"]));
        for (theirs, ours) in NAMES {
            let want = &case["integrators"][theirs];
            let (set, dt) = (format!("omega2={w2}"), dt.to_string());
            let million = ["--steps", "1000000"];
            let words = ["analyze", "--system", "oscillator", "--set", &set, "--dt", &dt];
            let words = [&words[..], &million].concat();
            let got = json(&[&words[..], &["--integrator", ours]].concat());
            let close = |got: &Value, want: &Value, key: &str| {
                let want = number(want);
                let got = got.as_f64().unwrap_or_else(|| panic!("{key} of {ours}: {got}"));
                let near = got == want || (got - want).abs() <= 1e-12 * want.abs();
                assert!(near, "{key} of {ours} at w2 = {w2}, dt = {dt}: {got:e}, not {want:e}");
            };
            for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                close(&got["update_matrix"][i][j], &want["M"][i][j], "update_matrix");
            }
            for (mine, key) in [
                ("determinant", "det"),
                ("trace", "trace"),
                ("spectral_radius", "spectral_radius"),
                ("spectral_radius_minus_one", "spectral_radius_minus_1"),
                ("symplecticity_defect", "MtJM_minus_J_frobenius"),
                ("reversibility_defect", "reversible_defect_frobenius_M(-dt)M(dt)-I"),
                ("phase_error_per_step", "phase_error_per_step"),
            ] {
                close(&got[mine], &want[key], mine);
            }
            let largest = want["max_rel_energy_drift_1e6"].as_str().unwrap();
            if number(&Value::from(largest)).is_finite() {
                close(&got["max_energy_drift"], &Value::from(largest), "max_energy_drift");
            } else {
                let (mantissa, exponent) = largest.split_once("e+").unwrap();
                let log10: f64 =
                    mantissa.parse::<f64>().unwrap().log10() + exponent.parse::<f64>().unwrap();
                let got = got["log10_max_energy_drift"].as_f64().unwrap();
                assert!((got / log10 - 1.0).abs() < 1e-12, "{ours}: 10^{got}, not 10^{log10}");
            }
        }
    }
}

#[test]
fn a_negative_velocity_and_several_coordinates_are_taken_as_they_stand() {
    let words = ["analyze", "--system", "oscillator", "--integrator", "leapfrog", "--dt", "0.1"];
    let got = json(&[&words[..], &["--q", "1,-2", "--v", "-0.3,4"]].concat());
    let start = |i: usize| got["system"]["states"][i]["start"].as_f64().unwrap();
    assert_eq!([start(0), start(1), start(2), start(3)], [1.0, -2.0, -0.3, 4.0]);
    assert_eq!(got["update_matrix"].as_array().unwrap().len(), 4);
    assert_eq!(got["bounded"], true);
}

#[test]
fn criteria_are_taken_and_wrong_ones_refused() {
    let words =
        ["analyze", "--system", "oscillator", "--integrator", "velocity-verlet", "--dt", "0.1"];
    let got = json(&[&words[..], &["--max-drift", "1e-3"]].concat());
    let dt = got["largest_dt"]["energy_drift"].as_f64().unwrap();
    assert!((dt - 0.02).abs() < 1e-15, "{dt}");
    assert!(got["largest_dt"]["amplitude"].is_null());
    for (flag, value) in [
        ("--max-drift", "0"),
        ("--max-amplitude", "-1"),
        ("--max-error", "nan"),
        ("--max-drift", "1e-300"),
        ("--max-amplitude", "inf"),
    ] {
        let output = libration(&[&words[..], &[flag, value]].concat()).code(2).get_output().clone();
        let error = String::from_utf8(output.stderr).unwrap();
        assert!(error.contains(flag) && error.contains("between 1e-60 and 1e60"), "{error}");
    }
}

#[test]
fn wrong_input_is_named_with_exit_code_2_and_nothing_on_stdout() {
    let kepler = ["analyze", "--system", "kepler", "--integrator", "rk4"];
    for (words, told) in [
        (&["--dt", "0.1", "--q", "0,0"][..], "--q must not be the origin"),
        (&["--dt", "0.1", "--q", "1"], "--q `1` has 1 coordinate"),
        (&["--dt", "0"], "greater than 0"),
        (&["--dt", "nan"], "greater than 0"),
        (&["--dt", "0.1", "--steps", "0"], "--steps"),
        (&["--dt", "0.1", "--set", "nu=1"], "`mu`"),
        (&["--dt", "0.1", "--set", "mu=-1"], "-1"),
    ] {
        let output = libration(&[&kepler[..], words].concat()).code(2).get_output().clone();
        let error = String::from_utf8(output.stderr).unwrap();
        assert!(error.contains(told), "{words:?}: {error}");
        assert!(output.stdout.is_empty(), "{words:?}");
    }
}

#[test]
fn a_linear_forecast_reaches_the_crossover_and_a_simulation_has_its_limit() {
    // RK4 has lost what Verlet swings by, z²/4 = 2.5·10⁻⁶, after 18/z⁴ = 1.8·10¹¹ steps.
    let words = ["analyze", "--integrator", "rk4", "--dt", "0.001", "--steps", "1.8e11"];
    let system = ["--system", "oscillator", "--set", "omega2=10"];
    let drift = json(&[&words[..], &system].concat())["max_energy_drift"].as_f64().unwrap();
    // 1 − e^−x = x to the next terms: x/2 of it and z².
    assert!((drift / 2.5e-6 - 1.0).abs() < 1e-5, "{drift}");
    libration(&[&words[..], &["--system", "pendulum"]].concat()).code(2);
}

#[test]
fn the_time_of_a_driven_oscillator_passes_at_its_own_rate() {
    let words = ["--system", "driven-oscillator", "--integrator", "rk4", "--dt", "0.1"];
    let refused = libration(&[&["analyze"], &words[..], &["--v", "0,2"]].concat()).code(2);
    let said = String::from_utf8(refused.get_output().stderr.clone()).unwrap();
    assert!(said.contains("--v") && said.contains("must be 1"), "{said}");
    libration(&[&["analyze"], &words[..], &["--v", "3,1"]].concat()).success();
}

#[test]
fn limits_are_printed_with_all_their_digits() {
    // Rounded to ten digits, the end of this window would be far outside.
    let words = "analyze --system oscillator --set omega2=10 --integrator yoshida4 --dt";
    let text = |dt: &str| {
        let mut command = Command::cargo_bin("libration").unwrap();
        let output = command.args(words.split(' ')).args([dt, "--verbose"]).output().unwrap();
        String::from_utf8_lossy(&output.stdout).into_owned()
    };
    let said = text("0.01");
    let row = said.lines().find(|line| line.contains("stable for dt")).unwrap();
    let limit: f64 = row.rsplit(' ').next().unwrap().parse().unwrap();
    // The float next to the limit may lie on either side of it.
    let below = (limit * (1.0 - 1e-14)).to_string();
    assert!(text(&below).contains("orbits                 bounded"), "{row}");
    let beyond = (limit * (1.0 + 1e-14)).to_string();
    assert!(text(&beyond).contains("orbits                 unbounded"), "{row}");
}
