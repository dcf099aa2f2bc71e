//! `libration analyze` of linear plants and loops around them, through the binary.

use std::fs;

use assert_cmd::assert::Assert;
use predicates::prelude::*;
use serde_json::Value;

use super::advise::libration;

/// A mass of 2 kg on a spring of 50 N/m with a damper of 0.4 N·s/m: 5 rad/s, damping ratio 0.02.
const MASS: &str = "\
mass = [[2]]
damping = [[0.4]]
stiffness = [[50]]
b = [[1]]
states = [\"position (m)\"]
inputs = [\"force (N)\"]
";

/// A heater that no input reaches, beside a lag.
const HEATER: &str = "\
a = [[-20, 0], [0, -0.5]]
b = [[4], [0]]
c = [[1, 0]]
states = [\"current (A)\", \"oil (K)\"]
";

fn analyze(plant: &str, options: &str) -> Assert {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("plant.toml");
    fs::write(&path, plant).unwrap();
    let words = ["analyze", "--plant", path.to_str().unwrap()];
    libration(&words.into_iter().chain(options.split_whitespace()).collect::<Vec<_>>())
}

fn json(assert: Assert) -> Value {
    serde_json::from_slice(&assert.success().get_output().stdout).unwrap()
}

fn step<'a>(analysis: &'a Value, name: &str) -> &'a Value {
    let steps = analysis["steps"].as_array().unwrap();
    steps.iter().find(|step| step["integrator"] == name).unwrap()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

#[test]
fn a_plant_has_modes_by_name_and_the_time_steps_of_each_integrator() {
    let analysis = json(analyze(MASS, "--json"));
    assert_eq!(analysis["schema"], "libration.linear-analysis/1");
    assert_eq!(analysis["mechanical"], true);
    let [mode] = &analysis["modes"].as_array().unwrap()[..] else { panic!("{analysis}") };
    assert!((number(&mode["natural_frequency"]) - 5.0).abs() < 1e-14, "{mode}");
    assert!((number(&mode["damping_ratio"]) - 0.02).abs() < 1e-15, "{mode}");
    assert!((number(&mode["time_constant"]) - 10.0).abs() < 1e-13, "{mode}");
    assert_eq!(mode["states"][0][0], "position'");
    // h < 2ζ/ω, and ωh < 2√(1+ζ²) − 2ζ of a kick that takes the damper with it.
    let euler = number(&step(&analysis, "explicit-euler")["largest_stable_dt"]);
    assert!((euler - 0.008).abs() < 1e-15, "{euler}");
    let symplectic = number(&step(&analysis, "symplectic-euler")["largest_stable_dt"]);
    let wanted = (2.0 * 1.0004_f64.sqrt() - 0.04) / 5.0;
    assert!((symplectic - wanted).abs() < 1e-14, "{symplectic} {wanted}");
    // Without a time step there are no multipliers.
    assert!(step(&analysis, "rk4")["spectral_radius"].is_null());
    assert_eq!(step(&analysis, "rk4")["stability_function"], "1 + z + z²/2 + z³/6 + z⁴/24");
}

#[test]
fn predictions_measurements_and_the_analysis_of_the_same_oscillator_agree() {
    let [dt, integrator] = ["0.1", "velocity-verlet"];
    let analysis = json(analyze(MASS, &format!("--dt {dt} --json")));
    // Its motion is not resolved, which is no matter of its numbers.
    let oscillator = libration(&[
        "analyze",
        "--system",
        "damped-oscillator",
        "--set",
        "omega2=25",
        "--set",
        "gamma=0.2",
        "--integrator",
        integrator,
        "--dt",
        dt,
        "--json",
    ]);
    let oscillator: Value = serde_json::from_slice(&oscillator.get_output().stdout).unwrap();
    let found = step(&analysis, integrator);
    let radius = number(&oscillator["spectral_radius"]);
    for key in ["predicted_spectral_radius", "spectral_radius"] {
        assert!((number(&found[key]) - radius).abs() < 1e-15, "{key}: {found} {radius}");
    }
    let simulated = number(&found["simulated"]["growth"]);
    assert!((simulated - radius).abs() < 1e-14, "{simulated} {radius}");
    let single = number(&found["simulated_f32"]["growth"]);
    assert!((single - radius).abs() < 1e-6 && single != simulated, "{single} {radius}");
    let phase = number(&found["modes"][0]["phase_error_per_step"]);
    assert!((phase - number(&oscillator["phase_error_per_step"])).abs() < 1e-14, "{phase}");
    let stable = number(&found["stable_dt"][0][1]);
    assert!((stable / number(&oscillator["stability_windows"][0][1]) - 1.0).abs() < 1e-14);
    let exact = number(&step(&analysis, "exact")["spectral_radius"]);
    // e^{−γ/2·h} with γ = 0.2.
    assert!((exact - (-0.01_f64).exp()).abs() < 1e-15, "{exact}");
}

#[test]
fn text_names_modes_that_no_input_reaches_and_integrators_that_do_not_apply() {
    let found = |text: &'static str| predicate::str::contains(text);
    analyze(HEATER, "--dt 0.01 --verbose")
        .success()
        .stdout(found("not controllable: no input reaches it; not observable: no output shows it"))
        .stdout(found("stiffness (their ratio) 4.0000e1"))
        .stdout(found("explicit-euler               0 to 0.1\n"))
        .stdout(found("not applicable, half of the states are not the rates of the other half: symplectic-euler"));
    analyze(HEATER, "--dt 0.01 --integrator rk4 --verbose")
        .success()
        .stdout(found("stability function, z = dt·λ: 1 + z + z²/2 + z³/6 + z⁴/24"))
        .stdout(found("exact growth per step"))
        .stdout(found("f32 less f64"));
}

#[test]
fn a_loop_has_the_modes_of_its_period_and_the_deviations_of_advise() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/loops/two_mass_drive.toml");
    let analysis = json(libration(&["analyze", "--config", path, "--json"]));
    let advice = json(libration(&["advise", "--config", path, "--json"]));
    let found = &analysis["loop"];
    assert_eq!(found["stable"], true);
    for (found, wanted) in
        [(&found["mean_square_growth"], &advice["growth"]), (&found["cost"], &advice["cost"])]
    {
        assert_eq!(found, wanted);
    }
    let deviations = found["deviations"].as_array().unwrap();
    for (found, wanted) in deviations.iter().zip(advice["deviations"].as_array().unwrap()) {
        assert_eq!(found["deviation"], wanted["stated"]);
    }
    assert_eq!(deviations.len(), 5);
    let mode = &found["modes"][0];
    assert_eq!(mode["growth"], found["spectral_radius"]);
    assert!(mode["states"][0][0].is_string());
    // A controller without --dt asks for no integrator.
    assert_eq!(analysis["steps"], Value::Array(vec![]));
}

#[test]
fn a_gain_of_zero_leaves_the_mode_of_the_plant() {
    let found = json(analyze(MASS, "--gain 0,0 --period 0.05 --latency 0.02 --json"));
    let mode = &found["loop"]["modes"][0];
    let plant = &found["modes"][0];
    for key in ["natural_frequency", "damping_ratio", "time_constant", "frequency"] {
        let (found, wanted) = (number(&mode[key]), number(&plant[key]));
        assert!((found / wanted - 1.0).abs() < 1e-12, "{key} {found} {wanted}");
    }
}

#[test]
fn options_without_sense_are_refused_with_what_is_expected() {
    let refused = |assert: Assert, text: &'static str| {
        assert.code(2).stdout("").stderr(predicate::str::contains(text));
    };
    for option in
        ["--steps 10", "--max-drift 1e-3", "--max-error 1", "--feedback 1,2", "--system oscillator"]
    {
        refused(analyze(MASS, option), "cannot be used with");
    }
    refused(analyze(MASS, "--dt -1"), "must be finite and greater than 0");
    refused(analyze(MASS, "--dt nan"), "must be finite and greater than 0");
    refused(
        analyze(MASS, "--jitter gaussian:0.1"),
        "--jitter is given, but there is no controller",
    );
    refused(analyze(MASS, "--period 0.1"), "expected --lqr or --gain");
    refused(
        analyze(HEATER, "--dt 0.1 --integrator leapfrog"),
        "--integrator leapfrog requires positions and velocities",
    );
    refused(
        analyze(HEATER, "--dt 0.1 --integrator leapfrog"),
        "expected explicit-euler, rk4, damping-stiffness-implicit",
    );
    let sampled = "a = [[0.5]]\nb = [[1]]\nsampling-period = 0.1\n";
    refused(analyze(sampled, "--dt 0.1"), "the plant is sampled every 0.1 s");
    analyze(sampled, "").success().stdout(predicate::str::contains("sampled every 0.1 s"));
    let words = ["analyze", "--system", "oscillator", "--integrator", "rk4", "--dt", "0.1"];
    for option in [["--lqr", "1/1"], ["--period", "0.1"], ["--output-latency", "0.1"]] {
        refused(libration(&[&words[..], &option].concat()), "cannot be used with");
    }
}

#[test]
fn plants_without_motion_and_equal_subsystems_have_modes() {
    let integrator = json(analyze("a = [[0]]\nb = [[1]]\n", "--dt 0.1 --json"));
    let mode = &integrator["modes"][0];
    assert_eq!(
        (&mode["growth_rate"], &mode["controllable"]),
        (&Value::from(0.0), &Value::from(true))
    );
    let joints = "mass = [[1, 0], [0, 1]]\nstiffness = [[100, 0], [0, 100]]\nb = [[1], [1]]\n";
    analyze(joints, "--verbose")
        .success()
        .stdout(predicate::str::contains(
            "the inputs do not reach all motions with this eigenvalue",
        ))
        .stdout(predicate::str::contains("no input reaches it").not());
    let modes = json(analyze(joints, "--json"));
    let first = |i: usize| modes["modes"][i]["states"][0][0].as_str().unwrap().to_owned();
    assert_ne!(first(0), first(1));
}
