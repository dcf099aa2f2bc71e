//! Verdicts at the limit of stability: one rule for all commands, and no rate that is rounding.

use serde_json::Value;

use super::advise::libration;
use super::linear::written;

fn answer(command: &str) -> (String, i32) {
    let words: Vec<&str> = command.split_whitespace().collect();
    let told = libration(&words);
    let output = told.get_output();
    (String::from_utf8(output.stdout.clone()).unwrap(), output.status.code().unwrap())
}

/// The outcome of a verdict in JSON, by its key. Some numbers there are beyond those of a parser.
fn outcome(command: &str, verdict: &str) -> String {
    let (text, _) = answer(&format!("{command} --json"));
    // The verdicts at the equilibrium stand before those of the request.
    let (_, own) =
        text.rsplit_once(&format!("\"{verdict}\": {{")).unwrap_or_else(|| panic!("{text}"));
    own.split('"').nth(3).unwrap().to_owned()
}

/// Both multipliers are −1 at ωh = 2 with one shape: deviations grow with the number of steps. With ω = 16 and h = 1/8 no number is rounded.
#[test]
fn a_step_at_the_limit_is_unstable_for_the_catalogue_the_plant_and_servos() {
    let folder = tempfile::tempdir().unwrap();
    let plant = written(&folder, "plant.toml", "a = [[0, 1], [-256, 0]]\nb = [[0], [1]]\n");
    for integrator in
        ["velocity-verlet", "symplectic-euler", "symplectic-euler-drift-first", "leapfrog"]
    {
        let step = format!("--integrator {integrator} --dt");
        let catalogue = format!("analyze --system oscillator --set omega2=256 {step}");
        let matrices = format!("analyze --plant {} {step}", plant.display());
        let servo = format!("gains --inertia 1 --kp 256 {step}");
        for (dt, wanted) in [("0.125", "unstable"), ("0.1249", "stable"), ("0.1251", "unstable")] {
            for (command, verdict) in
                [(&catalogue, "step"), (&matrices, "step"), (&servo, "verdict")]
            {
                assert_eq!(outcome(&format!("{command} {dt}"), verdict), wanted, "{command} {dt}");
            }
        }
        let (text, _) = answer(&format!("{matrices} 0.125"));
        assert!(!text.contains("stable at dt") && text.contains("without bound"), "{text}");
    }
}

/// Symplectic Euler needs h²k below 4, and hv below 2: of 0.5 s five parts are at the limit.
#[test]
fn the_fewest_substeps_are_inside_the_limit() {
    for (gains, fewest) in
        [("--kp 400", 6), ("--kp 0 --kv 20", 6), ("--kp 399", 5), ("--kp 256 --kv 0", 5)]
    {
        let command =
            format!("gains --inertia 1 {gains} --dt 0.5 --integrator symplectic-euler --json");
        let report: Value = serde_json::from_str(&answer(&command).0).unwrap();
        assert_eq!(report["fewest_substeps"], fewest, "{gains}");
    }
}

/// Exact steps of an undamped motion, of 1024 bits with roundings of 2⁻¹⁰⁰⁰ or in `f64`.
#[test]
fn a_rate_that_is_rounding_is_no_growth() {
    let folder = "--system oscillator --integrator exact --dt 0.1";
    for more in [
        "--feedback 0,0",
        "--feedback 0,0 --set omega2=0",
        "--feedback 0,0 --latency 0.05",
        "--feedback 0,0 --jitter gaussian:0.1",
        "--feedback 0,0 --loss 0.1",
        "--feedback 0,0 --latency 0.15 --jitter uniform:0.2",
        "--feedback 5,0 --set omega2=0.37",
    ] {
        let (text, code) = answer(&format!("analyze {folder} {more}"));
        let grows = more.contains("5,0");
        assert_eq!(text.starts_with("The loop is unstable"), grows, "{more}: {text}");
        assert!(!text.contains("e-298") && !text.contains("e-300"), "{more}: {text}");
        assert_eq!(code, 1, "{more}");
    }
}

/// Rounded coefficients of Dormand and Prince's integrator add 10⁻¹⁶ (ωh)² to its growth; that of explicit Euler is (ωh)²/2.
#[test]
fn growth_by_rounded_coefficients_is_no_verdict() {
    for (integrator, wanted) in [("dormand-prince-5", "unknown"), ("explicit-euler", "unstable")] {
        let step = format!("--integrator {integrator} --dt 1e-9");
        let command = format!("analyze --system oscillator --set omega2=400 {step}");
        assert_eq!(outcome(&command, "step"), wanted, "{integrator}");
    }
}

/// Explicit Euler grows by (ωh)²/2 = 2·10⁻¹⁶ per step, which no `f64` shows.
#[test]
fn a_step_is_not_stable_beside_never_stable() {
    let folder = tempfile::tempdir().unwrap();
    let plant = written(&folder, "plant.toml", "a = [[0, 1], [-400, 0]]\nb = [[0], [1]]\n");
    for (dt, wanted) in [("1e-9", "unknown"), ("3e-10", "unknown"), ("1e-6", "unstable")] {
        let step = format!("--plant {} --integrator explicit-euler --dt {dt}", plant.display());
        assert_eq!(outcome(&format!("analyze {step}"), "step"), wanted, "{dt}");
        let (text, code) = answer(&format!("analyze {step}"));
        assert!(text.contains("never stable: explicit-euler") && code == 1, "{text}");
        assert!(!text.starts_with("explicit-euler") || wanted == "unstable", "{text}");
    }
}

/// Every step moves a free mass exactly: verdict, table and advice say so, for the catalogue and for matrices.
#[test]
fn a_free_mass_has_one_answer_by_both_doors() {
    let folder = tempfile::tempdir().unwrap();
    let plant = written(&folder, "plant.toml", "a = [[0, 1], [0, 0]]\nb = [[0], [1]]\n");
    for integrator in ["velocity-verlet", "rk4", "backward-euler", "explicit-euler"] {
        let step = format!("--integrator {integrator} --dt 0.1");
        let free = "analyze --system oscillator --set omega2=0";
        let (text, code) = answer(&format!("{free} {step}"));
        let words = text.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(words.contains("is stable on oscillator"), "{text}");
        assert!(words.contains("in proportion to time, as those of exact steps do"), "{text}");
        assert!(words.contains("stable for dt in s 0 to ∞"), "{text}");
        // Nothing to change: no command is recommended.
        assert!(!words.contains("Take an integrator") && !words.contains("advise"), "{text}");
        let (text, of_plant) = answer(&format!("analyze --plant {} {step}", plant.display()));
        assert!(text.contains(&format!("stable at dt = 0.1 s: {integrator}")), "{text}");
        assert_eq!((code, of_plant), (0, 0), "{integrator}");
    }
}

#[test]
fn verdicts_of_gains_and_their_exit_codes_are_those_of_closed_forms() {
    for (gains, wanted, said) in [
        // det = 1 + kp h²/2 under a held torque.
        (
            "--kp 0.00001 --kv 0 --dt 0.1 --held-torque --integrator rk4",
            1,
            "no tried factor of all gains of position makes them hold",
        ),
        // kp < 2 (2 − kv h)/h² = 2.
        ("--kp 2.00001 --kv 19.9 --dt 0.1", 1, "must stay below 2,"),
        ("--kp 1 --kv 0 --dt 1e-6", 0, "must stay below 4·10¹²,"),
        ("--kp 400 --kv 0 --dt 0.1", 1, "at the limit of stability"),
        (
            "--kp 1e-8 --kv 0 --dt 0.1 --integrator explicit-euler",
            1,
            "by a factor 1 + 5·10⁻¹¹ per step",
        ),
    ] {
        let (text, code) = answer(&format!("gains --inertia 1 {gains}"));
        assert_eq!(code, wanted, "{gains}: {text}");
        assert!(text.contains(said), "{text}");
        assert_eq!(text.starts_with("The gains hold"), wanted == 0, "{text}");
    }
    let (text, code) = answer("gains --inertia 1e-300 --kp 1 --kv 0 --dt 1e-200");
    assert!(code == 0 && text.contains("must stay below 4·10¹⁰⁰,"), "{text}");
}

#[test]
fn a_number_that_is_missing_is_not_printed() {
    let duffing =
        "advise --system duffing --set alpha=1 --set beta=-1 --feedback 0.1,1 --period 0.05 --q 0";
    for (command, said) in [
        (format!("{duffing} --deviation 2"), "each tried step loses the motion"),
        (format!("{duffing} --deviation 3 --horizon 30"), "each tried step loses the motion"),
        ("gains --inertia 1 --kp 0 --kv 1 --dt 0.01".to_owned(), "The gains hold"),
        ("gains --inertia 1 --kp 0 --dt 0.01".to_owned(), "there are no gains"),
        (
            "analyze --system oscillator --set omega2=0 --integrator rk4 --dt 0.1".to_owned(),
            "is stable",
        ),
    ] {
        let text = answer(&command).0.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(text.contains(said), "{text}");
        let is_number = |word: &str| !["NaN", "inf"].contains(&word.trim_matches([',', ';', '.']));
        assert!(text.split_whitespace().all(is_number), "{command}: {text}");
    }
}
