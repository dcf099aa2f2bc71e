//! Verdicts on plants and loops: structure, stability by one function, limits on the safe side, and errors of timing.

use serde_json::Value;
use tempfile::TempDir;

use super::advise::libration;
use super::linear::written;

pub(crate) fn words(text: &str) -> Vec<&str> {
    text.split_whitespace().collect()
}

/// The output of a command with this exit code.
pub(crate) fn output(command: &str, code: i32) -> String {
    let told = libration(&words(command)).code(code);
    String::from_utf8(told.get_output().stdout.clone()).unwrap()
}

pub(crate) fn json(command: &str, code: i32) -> Value {
    serde_json::from_str(&output(&format!("{command} --json"), code)).unwrap()
}

fn complaint(command: &str, code: i32) -> String {
    let told = libration(&words(command)).code(code);
    String::from_utf8(told.get_output().stderr.clone()).unwrap()
}

pub(crate) fn plant(folder: &TempDir, name: &str, text: &str) -> String {
    let path = written(folder, name, text);
    path.to_str().unwrap().to_owned()
}

const CART: &str = "\
a = [[0, 1], [0, 0]]
b = [[0], [1]]
c = [[1, 0], [0, 1]]
d = [[0], [0]]
";

const HILLTOP: &str = "\
a = [[0, 1], [9.81, 0]]
b = [[0], [1]]
c = [[1, 0], [0, 1]]
d = [[0], [0]]
";

/// A request for the loop `u = −P y` around a transfer function.
fn proportional(numerator: &str, denominator: &str, gain: f64, period: &str) -> String {
    format!(
        "[system.linear]\nnumerator = [{numerator}]\ndenominator = [{denominator}]\n\
         [[controller.pid]]\noutput = \"y1\"\ninput = \"u1\"\nproportional = {gain}\n\
         [loop]\nperiod = {period}\n"
    )
}

#[test]
fn poles_far_apart_hide_no_mode_and_a_zero_beside_a_pole_does() {
    let folder = tempfile::tempdir().unwrap();
    let motor = "\
a = [[0, 1, 0], [0, -1.0865134431917979, 8487.17630987486], [0, -9963.636363636364, -1454545.4545454546]]
b = [[0], [0], [363636.36363636365]]
c = [[1, 0, 0]]
d = [[0]]
";
    // (s + 1)(s + 10)(s + 100)(s + 1000)(s + 10⁴), and two others without zeros.
    for (name, text) in [
        ("three", "numerator = [1]\ndenominator = [1, 1e4, 1e6, 1e6]\n"),
        ("four", "numerator = [1]\ndenominator = [1, 1e3, 1e6, 1e9, 1e10]\n"),
        (
            "five",
            "numerator = [1]\ndenominator = [1, 11111, 11222110, 1122211000, 11111000000, 1e10]\n",
        ),
        ("lags", "numerator = [1]\ndenominator = [1e-12, 1e-6, 1e-2, 1]\n"),
        ("motor", motor),
    ] {
        let file = plant(&folder, &format!("{name}.toml"), text);
        let told = output(&format!("analyze --plant {file}"), 0);
        assert!(!told.contains("observable") && !told.contains("controllable"), "{name}: {told}");
    }
    // (s + 1)(s + 5) over (s + 1)(s + 2)(s + 3), and a zero at −1.0000001.
    for (name, zeros, said) in [
        ("cancelled", "1, 6, 5", "not observable"),
        ("near", "1, 6.0000001, 5.0000005", "weakly observable"),
        ("apart", "1, 6.01, 5.05", ""),
    ] {
        let text = format!("numerator = [{zeros}]\ndenominator = [1, 6, 11, 6]\n");
        let file = plant(&folder, &format!("{name}.toml"), &text);
        let told = output(&format!("analyze --plant {file}"), 0);
        assert_eq!(told.contains("observable"), !said.is_empty(), "{name}: {told}");
        assert!(told.contains(said), "{name}: {told}");
    }
}

/// Products of blocks have poles that zeros nearly cancel; in short periods such a motion changes by less than rounding. The sign of
/// the constant term of the closed denominator decides: the sum of those of numerator (times P) and denominator.
#[test]
fn analyze_and_advise_give_one_verdict_on_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let blocks = "3.4e-14, 3.7e-7, 1.4, 2.5e6";
    for (name, text, outcome) in [
        (
            "public",
            proportional("0.4, 2.5e6, 1.9", &format!("{blocks}, 1.9"), 1.0, "25e-9"),
            "stable",
        ),
        (
            "growing",
            proportional("0.4, 2.5e6, -1.9", &format!("{blocks}, -1.9"), 1.0, "25e-9"),
            "unstable",
        ),
        ("slow", proportional("1", "1, 1e-6", 0.0, "1e-8"), "stable"),
        ("slow-growth", proportional("1", "1, -1e-6", 0.0, "1e-8"), "unstable"),
        ("held", proportional("1", "1, -1e-6", 3e-6, "1e-8"), "stable"),
        ("free", proportional("1", "1, 0", 0.0, "0.01"), "unknown"),
        ("undamped", proportional("1", "1, 0, 4", 0.0, "0.01"), "unknown"),
        ("fast", proportional("1", "1, 1", 1.0, "0.01"), "stable"),
    ] {
        let file = plant(&folder, &format!("{name}.toml"), &text);
        let code = i32::from(outcome != "stable");
        let advised = json(&format!("advise --config {file}"), code);
        assert_eq!(advised["verdict"]["outcome"], outcome, "{name}: {}", advised["answer"]);
        let told = libration(&words(&format!("analyze --config {file} --json")));
        let analysed: Value = serde_json::from_slice(&told.get_output().stdout).unwrap();
        assert_eq!(analysed["loop"]["verdict"]["outcome"], outcome, "{name}");
        if name == "public" {
            let warnings = advised["warnings"].to_string();
            assert!(warnings.contains("at −7.6·10⁻⁷ 1/s (a zero cancels its pole"), "{warnings}");
        }
    }
}

#[test]
fn a_loop_of_the_wrong_sign_has_a_page_and_json_and_is_told_its_sign_first() {
    let folder = tempfile::tempdir().unwrap();
    let page = folder.path().join("page.html");
    let cart = plant(&folder, "cart.toml", CART);
    let hilltop = plant(&folder, "hilltop.toml", HILLTOP);
    for (command, next) in [
        (format!("advise --plant {cart} --gain=-30,-8 --period 5ms"), "--gain=30,8"),
        (format!("advise --plant {hilltop} --gain=-30,-8 --period 5ms"), "--gain=30,8"),
        (format!("advise --plant {cart} --gain=-1,-2 --period 0.1 --latency 20ms"), "--gain=1,2"),
        (
            "advise --system oscillator --set omega2=0 --feedback=-10,-2 --period 5ms".into(),
            "--feedback=10,2",
        ),
        (
            "advise --system pendulum --q 3.141592653589793 --feedback=-30,-8 --period 5ms".into(),
            "--feedback=30,8",
        ),
        ("advise --system duffing --feedback=-30,-8 --period 5ms".into(), "--feedback=30,8"),
    ] {
        let told = json(&command, 1);
        assert_eq!(told["verdict"]["outcome"], "unstable", "{command}: {told}");
        let answer = told["answer"].as_str().unwrap();
        assert!(answer.contains("It is stable with the opposite sign of all gains"), "{answer}");
        let screen = output(&format!("{command} --page {}", page.display()), 1);
        assert!(screen.contains(next), "{command}: {screen}");
        let html = std::fs::read_to_string(&page).unwrap();
        assert!(
            html.contains("The loop is unstable") && html.contains("opposite sign"),
            "{command}"
        );
        assert!(html.contains("stability-map"), "{command}");
        std::fs::remove_file(&page).unwrap();
    }
    // Too much gain in a period that is too long: the sign is right.
    let coarse = json(&format!("advise --plant {cart} --gain 30,8 --period 0.5"), 1);
    let answer = coarse["answer"].as_str().unwrap();
    assert!(!answer.contains("opposite sign") && answer.contains("all gains times 0."), "{answer}");
}

#[test]
fn factors_and_margins_in_words_are_stable_themselves() {
    let folder = tempfile::tempdir().unwrap();
    let cart = plant(&folder, "cart.toml", CART);
    for (gain, period, latency) in [
        ("30,8", 0.005, 0.0217),
        ("10,5", 0.01, 0.0331),
        ("4,2", 0.02, 0.05),
        ("50,9", 0.004, 0.0123),
        ("7,3", 0.013, 0.0271),
        ("90,16", 0.003, 0.0077),
    ] {
        let command = |latency: f64| {
            format!("advise --plant {cart} --gain {gain} --period {period} --latency {latency}")
        };
        let told = json(&command(latency), 0);
        let answer = told["answer"].as_str().unwrap();
        let (before, _) = answer.split_once(" times as large").unwrap();
        let shown: f64 = before.rsplit(' ').next().unwrap().parse().unwrap();
        let factor = told["margin"].as_f64().unwrap();
        // Four digits, cut.
        assert!(shown <= factor && factor - shown < 1e-3 * factor, "{shown} {factor}");
        // The stated latency times the shown factor is stable.
        assert_eq!(json(&command(shown * latency), 0)["verdict"]["outcome"], "stable");
        let screen = output(&command(latency), 0);
        let margins = screen.split_once("gain from ").unwrap().1;
        let number = |text: &str| -> f64 {
            text.split([' ', ',']).find(|word| !word.is_empty()).unwrap().parse().unwrap()
        };
        let up = number(margins.split_once(" to ").unwrap().1);
        let phase = number(margins.split_once("phase ").unwrap().1);
        let exact = &told["margins"][0];
        assert!(up <= exact["gain_up"].as_f64().unwrap(), "{screen}");
        assert!(phase <= exact["phase"].as_f64().unwrap(), "{screen}");
    }
}

#[test]
fn a_latency_in_the_wrong_unit_is_named_with_the_right_one_in_each_command() {
    let folder = tempfile::tempdir().unwrap();
    let cart = plant(&folder, "cart.toml", CART);
    let text = "12 is 12 s, 2400 periods; did you mean 12ms?";
    let looped = format!("--plant {cart} --gain 30,8 --period 5ms");
    for command in [
        format!("advise {looped} --latency 12"),
        format!("advise {looped} --output-latency 12"),
        format!("advise {looped} --latency 12 --jitter gaussian:0.1"),
        format!("analyze {looped} --latency 12"),
        format!("simulate {looped} --latency 12 --steps 10"),
        "advise --system oscillator --feedback 10,2 --period 5ms --latency 12".to_owned(),
    ] {
        let told = complaint(&command, 2);
        assert!(told.contains(text), "{command}: {told}");
    }
    for command in [
        "analyze --system oscillator --feedback 10,2 --integrator rk4 --dt 5ms --latency 40",
        "simulate --system oscillator --feedback 10,2 --integrator rk4 --dt 5ms --steps 10 --latency 40",
    ] {
        let told = complaint(command, 2);
        assert!(told.contains("40 is 40 s, 8000 periods; did you mean 40ms?"), "{command}: {told}");
    }
}

#[test]
fn laws_by_other_names_are_named_as_what_they_are() {
    let command = "advise --system oscillator --feedback 10,2 --jitter";
    for (law, meant) in [
        ("normal:0.05", "gaussian:0.05"),
        ("gauss:0.1", "gaussian:0.1"),
        ("Normal:0.1", "gaussian:0.1"),
        ("rectangular:0.2", "uniform:0.2"),
        ("unifrom:0.2", "uniform:0.2"),
    ] {
        let told = complaint(&format!("{command} {law}"), 2);
        assert!(told.contains(&format!("did you mean {meant}?")), "{told}");
    }
}

#[test]
fn a_delay_as_long_as_an_episode_is_refused_with_both_times() {
    let folder = tempfile::tempdir().unwrap();
    for (delays, substeps, refused) in [
        (
            "action = 40",
            1,
            "`delays.action` is 800 steps, 40 s, but an episode lasts 200 steps, 10 s",
        ),
        ("observation = ['10s', 15]", 1, "`delays.observation` is 200 steps, 10 s"),
        (
            "action = 45.0",
            4,
            "`delays.action` is 900 steps, 45 s, but an episode lasts 800 steps, 40 s",
        ),
        ("action = [0, 15]", 1, ""),
        ("action = '39950ms'", 4, ""),
    ] {
        let text = format!(
            "num_envs = 2\nsteps = 4\ndt = 0.05\nmax_episode_steps = 200\nsubsteps = {substeps}\n[delays]\n{delays}\n"
        );
        let file = plant(&folder, "rollout.toml", &text);
        let out = folder.path().join(format!("{substeps}{}", delays.len()));
        let command = format!("rollout --config {file} --out {}", out.display());
        let told = complaint(&command, if refused.is_empty() { 0 } else { 2 });
        assert!(told.contains(refused), "{delays}: {told}");
    }
}
