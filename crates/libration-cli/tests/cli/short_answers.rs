//! The short answers of `advise` and `analyze`, and the whole text of `--verbose`.

use std::fs;
use std::path::{Path, PathBuf};

use assert_cmd::Command;
use serde_json::Value;
use tempfile::TempDir;

use super::linear::example;

/// Lines and columns of a screen.
const SCREEN: [usize; 2] = [24, 100];

/// Requests with the part of the answer that warns, or decides.
const FORMS: [(&str, &str); 23] = [
    (
        "advise --system pendulum --feedback 10,2 --period 20ms --latency 12ms --horizon 1",
        "The loop is stable",
    ),
    (
        "advise --system oscillator --feedback 10,2 --period 0.02 --latency 0.2 --horizon 1",
        "The loop is unstable with the stated imperfections",
    ),
    (
        "advise --system oscillator --feedback 10,2 --latency 0.05 --loss 0.3 --tolerance cost=0.05 --horizon 1",
        "reduce to all imperfections at most",
    ),
    (
        "advise --system oscillator --feedback 0,1e-6 --period 0.01 --horizon 1",
        "warning: the loop was not simulated because it decays too slowly",
    ),
    (
        "advise --system oscillator --tolerance energy=1e-4 --horizon 1.3",
        "but may not resolve the motion",
    ),
    ("advise --system kepler --tolerance trajectory=1e-17 --horizon 0.005", "No integrator keeps"),
    ("advise --config examples/loops/two_mass_drive.toml", "Latency fails first"),
    (
        "advise --config {folder}/furuta_pendulum.toml",
        "With at most 2 of any 5 deadlines missed (kill, hold) it is stable",
    ),
    (
        "advise --system examples/systems/cart_pole.toml --lqr 1,10,0,1/0.1 --period 0.02 --latency 0.03",
        "--redesign",
    ),
    (
        "analyze --system oscillator --integrator explicit-euler --dt 0.01",
        "is unstable on oscillator",
    ),
    (
        "analyze --system oscillator --integrator exact --dt 0.01 --feedback 10,2 --latency 0.16 --jitter gaussian:0.1",
        "The loop is unstable",
    ),
    (
        "analyze --system damped-oscillator --integrator textbook-verlet --dt 0.1",
        "note: the force of `damped-oscillator` depends on",
    ),
    (
        "analyze --system pendulum --q 2.5 --integrator gauss-legendre-4 --dt 0.1 --steps 100",
        "linearised at q = 3.141593 rad",
    ),
    (
        "analyze --config examples/loops/two_mass_drive.toml --dt 0.001",
        "unstable there: explicit-euler (up to 0.0008 s)",
    ),
    (
        "analyze --plant {folder}/heater.toml --dt 0.01",
        "warning: mode 1 of the plant not controllable",
    ),
    (
        "analyze --system examples/systems/double_pendulum.toml --integrator rk4 --dt 0.3 --steps 1000",
        "does not resolve the motion",
    ),
    (
        "analyze --system pendulum --compare --tolerance 1e-4 --horizon 5",
        "do not meet the tolerance",
    ),
    (
        "analyze --system pendulum --temperature 1 --friction 1 --dt 0.2 --steps 1000",
        "warning: euler-maruyama: not stable: dt must be below 0.10194 s",
    ),
    (
        "advise --config examples/loops/furuta_pendulum.toml --redesign",
        "It is still stable with 4 of 10. Redesign: Its cost",
    ),
    // Nothing but the cost of the loop fails.
    (
        "advise --system oscillator --feedback 10,2 --latency 0.02 --tolerance cost=0.01 --horizon 1",
        "--tolerance cost=0.16",
    ),
    // The motion grows, not its error.
    (
        "analyze --system examples/systems/cart_pole.toml --integrator rk4 --dt 0.01 --steps 1000",
        "only the growth of the plant at dt = 0.01 s: rk4 (up to 0.7009 s)",
    ),
    // The rounding of parameters decides here, and growth as small is one where none is rounded.
    (
        "analyze --system damped-oscillator --integrator explicit-euler --dt 0.02",
        "at the limit of stability",
    ),
    (
        "analyze --system oscillator --integrator explicit-euler --dt 1e-9",
        "motions grow by 5e-16 % per step",
    ),
];

/// A plant with a mode that no input reaches.
const HEATER: &str = "a = [[-20, 0], [0, -0.5]]\nb = [[4], [0]]\nc = [[1, 0]]\n";

/// Writes the example `furuta_pendulum.toml` with deadlines of 5 periods: far fewer sequences than those of 10.
pub(crate) fn write_pendulum(folder: &Path) -> PathBuf {
    let text = fs::read_to_string(example("furuta_pendulum.toml")).unwrap();
    let path = folder.join("furuta_pendulum.toml");
    fs::write(&path, text.replace("2 of 10", "2 of 5")).unwrap();
    path
}

fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("heater.toml"), HEATER).unwrap();
    write_pendulum(folder.path());
    folder
}

/// The folder of the examples.
const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

/// The words of a request of [`FORMS`].
fn words(request: &str, folder: &Path) -> Vec<String> {
    let request = request.replace("{folder}", folder.to_str().unwrap());
    request.split_whitespace().map(str::to_owned).collect()
}

/// The output with more words, and whether the request holds.
fn printed(words: &[String], more: &[&str]) -> (String, Option<i32>) {
    let mut command = Command::cargo_bin("libration").unwrap();
    let output = command.current_dir(ROOT).arg("-q").args(words).args(more).output().unwrap();
    (String::from_utf8(output.stdout).unwrap(), output.status.code())
}

/// The texts of a value, of which the whole text must have each.
fn collect_names(value: &Value, found: &mut Vec<String>) {
    match value {
        Value::Object(fields) => {
            for (key, value) in fields {
                let names = ["answer", "integrator", "state", "part", "thermostat", "method"];
                match value {
                    Value::String(text)
                        if names.contains(&key.as_str()) || text.starts_with("libration ") =>
                    {
                        found.push(text.clone());
                    }
                    value => collect_names(value, found),
                }
            }
        }
        Value::Array(values) => values.iter().for_each(|value| collect_names(value, found)),
        _ => {}
    }
}

/// Runs the command that an answer proposes, and returns its exit code.
fn proposed(text: &str) -> Option<i32> {
    let program = assert_cmd::cargo::cargo_bin("libration");
    let path = std::env::var("PATH").unwrap();
    let path = format!("{}:{path}", program.parent().unwrap().display());
    let from = text.find("  libration ").unwrap_or_else(|| panic!("{text}"));
    let to = text.find("--verbose adds").unwrap();
    let mut shell = std::process::Command::new("sh");
    let ran = shell.args(["-c", &text[from..to]]).current_dir(ROOT).env("PATH", &path).output();
    ran.unwrap().status.code()
}

/// Fails unless the whole text has each name and command of the JSON.
fn check_whole_text(words: &[String], short: &str, code: Option<i32>) {
    let (whole, same) = printed(words, &["--verbose"]);
    let (json, again) = printed(words, &["--json"]);
    assert_eq!([code, again], [same; 2], "{words:?}");
    let mut names = Vec::new();
    collect_names(&serde_json::from_str(&json).unwrap(), &mut names);
    // The command that repeats the request with all digits is this one.
    let is_own = |name: &&String| name.ends_with("--json");
    for name in names.iter().filter(|name| !is_own(name)) {
        assert!(whole.contains(name.as_str()), "{name} of {words:?}:\n{whole}");
    }
    assert!(names.len() > 3 && whole.lines().count() >= short.lines().count());
}

/// Requests whose proposed command runs with exit code 0. Steps of half the length do not resolve a chaotic motion.
const PROPOSED: [usize; 5] = [1, 9, 10, 14, 19];
/// Requests whose whole text has what the JSON has.
const WHOLE: [usize; 4] = [1, 7, 13, 17];

#[test]
fn each_answer_fits_a_screen_keeps_its_warning_and_proposes_a_command_that_runs() {
    let folder = folder();
    for (i, (request, part)) in FORMS.into_iter().enumerate() {
        let words = words(request, folder.path());
        let (text, code) = printed(&words, &[]);
        let widest = text.lines().map(|line| line.chars().count()).max().unwrap();
        assert!(text.lines().count() <= SCREEN[0] && widest <= SCREEN[1], "{request}\n{text}");
        let joined = text.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(joined.contains(part), "{part} of {request}:\n{text}");
        assert!(!text.contains("0.0e0") && !text.contains("+0e0"), "{request}\n{text}");
        let last = text.lines().rev().find(|line| !line.starts_with(' ')).unwrap();
        assert!(last.starts_with("--verbose adds "), "{request}\n{text}");
        if PROPOSED.contains(&i) {
            assert_eq!(proposed(&text), Some(0), "{text}");
        }
        if WHOLE.contains(&i) {
            check_whole_text(&words, &text, code);
        }
    }
}

#[test]
fn the_command_that_repeats_an_answer_has_no_option_of_its_output() {
    let words = words(FORMS[1].0, Path::new("."));
    for flag in ["--verbose", "-v"] {
        let (text, _) = printed(&words, &[flag]);
        let repeat = text.lines().last().unwrap();
        assert!(repeat.starts_with("repeat with: libration -q advise"), "{text}");
        assert!(!repeat.split(' ').any(|word| word == flag), "{text}");
    }
}
