//! The first sentence and the exit code of `libration analyze`.

use std::fs;

use assert_cmd::Command;
use serde_json::Value;

/// A mass on a spring with 25 s⁻² and a damper of 0.2 s⁻¹.
const MASS: &str = "a = [[0, 1], [-25, -0.2]]\nb = [[0], [1]]\nc = [[1, 0]]\n";

/// Two oscillators that a gyroscopic force couples: `w² = 10`, `2O = 1`.
const GYROSCOPE: &str = "a = [[0, 0, 1, 0], [0, 0, 0, 1], [-10, 0, 0, 1], [0, -10, -1, 0]]\nb = [[0], [0], [1], [0]]\nc = [[1, 0, 0, 0]]\n";

/// The text, as one line, and the exit code.
fn answer(words: &[&str]) -> (String, i32) {
    let output = Command::cargo_bin("libration").unwrap().arg("-q").args(words).output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    let error = String::from_utf8(output.stderr).unwrap();
    assert!(error.is_empty(), "{words:?}: {error}");
    (text.split_whitespace().collect::<Vec<_>>().join(" "), output.status.code().unwrap())
}

/// Asserts the start of the first sentence and the exit code, of the text and of the JSON.
fn check(words: &str, sentence: &str, code: i32) -> Value {
    let words: Vec<&str> = words.split('|').flat_map(split).collect();
    let (text, found) = answer(&words);
    assert!(text.starts_with(sentence), "{words:?}\n{text}");
    assert_eq!(found, code, "{words:?}\n{text}");
    let (json, same) = answer(&[&words[..], &["--json"]].concat());
    assert_eq!(same, code, "{words:?}");
    let json: Value = serde_json::from_str(&json).unwrap();
    let verdicts = json["verdicts"].as_object().unwrap();
    let is_good =
        |verdict: &Value| ["stable", "resolved"].contains(&verdict["outcome"].as_str().unwrap());
    // A plant that is unstable by itself is no fault of a step.
    let mut judged = verdicts.iter().filter(|(name, _)| *name != "plant");
    assert_eq!(i32::from(!judged.all(|(_, verdict)| is_good(verdict))), code, "{json}");
    Value::Object(verdicts.clone())
}

/// Words, of which those in quotes stay together.
fn split(part: &str) -> Vec<&str> {
    match part.strip_prefix('\'') {
        Some(whole) => vec![whole],
        None => part.split_whitespace().collect(),
    }
}

#[test]
fn an_unstable_step_is_the_first_sentence_and_exit_code_1_at_each_door() {
    let folder = tempfile::tempdir().unwrap();
    let [mass, gyroscope] =
        [("mass.toml", MASS), ("gyroscope.toml", GYROSCOPE)].map(|(name, text)| {
            let path = folder.path().join(name);
            fs::write(&path, text).unwrap();
            path.display().to_string()
        });
    let verlet = "velocity-verlet in steps of 2.05 s is unstable on";
    for (words, sentence) in [
        (
            "analyze --system oscillator --set omega2=1 --integrator velocity-verlet --dt 2.05 --steps 100"
                .to_owned(),
            verlet,
        ),
        ("analyze --force|'-q0|--q 1 --integrator velocity-verlet --dt 2.05".to_owned(), verlet),
        (
            "analyze --force|'-q0|--integrator rk4 --dt 3".to_owned(),
            "rk4 in steps of 3 s is unstable on force: motions grow by 50.5",
        ),
        (
            "analyze --force|'-q0-10*v0|--integrator symplectic-euler --dt 0.21".to_owned(),
            "symplectic-euler in steps of 0.21 s is unstable",
        ),
        (
            format!("analyze --plant {mass} --integrator explicit-euler --dt 0.1"),
            "explicit-euler in steps of 0.1 s is unstable on the plant: spectral radius 1 + ",
        ),
        (
            format!("analyze --plant {mass} --integrator velocity-verlet --dt 0.5"),
            "velocity-verlet in steps of 0.5 s is unstable",
        ),
        // A kick takes gyroscopic forces as explicit Euler does: 5.35e-5 per step.
        (
            format!("analyze --plant {gyroscope} --integrator velocity-verlet --dt 0.01"),
            "velocity-verlet in steps of 0.01 s is unstable on the plant: spectral radius 1 + 5.3",
        ),
    ] {
        let verdicts = check(&words, sentence, 1);
        assert_eq!(verdicts["step"]["outcome"], "unstable", "{words}");
    }
    for words in [
        format!("analyze --plant {mass} --integrator rk4 --dt 0.1"),
        format!("analyze --plant {gyroscope} --integrator implicit-midpoint --dt 1"),
        "analyze --system oscillator --integrator yoshida4 --dt 0.02".to_owned(),
    ] {
        let verdicts = check(
            &words,
            words.split("--integrator ").nth(1).unwrap().split(' ').next().unwrap(),
            0,
        );
        assert_eq!(verdicts["step"]["outcome"], "stable", "{words}");
    }
    // A table of all integrators has no verdict of its own.
    assert_eq!(answer(&["analyze", "--plant", &mass, "--dt", "0.1"]).1, 0);
}

#[test]
fn an_unstable_loop_has_exit_code_1() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mass.toml");
    fs::write(&path, MASS).unwrap();
    let path = path.display();
    let exact = "analyze --system oscillator --integrator exact --dt 0.01 --feedback 10,2";
    for (words, sentence, code) in [
        (format!("{exact} --latency 0.05"), "The loop is stable:", 0),
        (format!("{exact} --latency 0.3"), "The loop is unstable:", 1),
        (format!("{exact} --latency 0.05 --loss 0.99"), "The loop is unstable:", 1),
        (
            format!("analyze --plant {path} --gain|'30,8|--period 0.01"),
            "The loop is stable with a period of 0.01 s:",
            0,
        ),
        (
            format!("analyze --plant {path} --gain|'30,8|--period 0.01 --latency 0.5"),
            "The loop is unstable with a period",
            1,
        ),
        (
            format!("analyze --plant {path} --gain|'0,-1|--period 0.01"),
            "The loop is unstable with a period",
            1,
        ),
    ] {
        check(&words, sentence, code);
    }
}

#[test]
fn a_motion_that_is_not_resolved_or_not_known_has_exit_code_1() {
    for (words, sentence, code) in [
        (
            "analyze --system pendulum --q 2.5 --integrator rk4 --dt 0.02 --steps 500",
            "rk4 in steps of 0.02 s on pendulum (omega2 = 9.81) resolves the motion over 500 steps (10 s): the largest error is",
            0,
        ),
        (
            "analyze --system pendulum --q 2.5 --integrator velocity-verlet --dt 0.3 --steps 5000",
            "velocity-verlet in steps of 0.3 s on pendulum (omega2 = 9.81) does not resolve the motion over 5000 steps",
            1,
        ),
        (
            "analyze --system kepler --q 1,0 --v 0,0.2 --integrator rk4 --dt 0.05 --steps 500",
            "rk4 in steps of 0.05 s on kepler (mu = 1) does not resolve the motion",
            1,
        ),
        (
            "analyze --force|'-9.81*sin(q0)|--q 1 --integrator dormand-prince-5 --dt 0.05 --steps 1000",
            "dormand-prince-5 in steps of 0.05 s on force resolves the motion over 1000 steps (50 s)",
            0,
        ),
        // Its growing mode has a third of its rate, which is less than 1 % of the motion by then.
        (
            "analyze --force|'-26.94*q0+0.06914*v0|--q 1 --v 1 --integrator stable-pd --dt 0.0017 --steps 200",
            "stable-pd in steps of 0.0017 s on force resolves the motion over 200 steps",
            0,
        ),
        // Chaos: beyond 21 s two references of different tolerance differ.
        (
            "analyze --system ../../examples/systems/lorenz.toml --integrator dormand-prince-8 --dt 0.002 --steps 15000",
            "Whether dormand-prince-8 in steps of 0.002 s on Lorenz (beta = 2.666666667, rho = 28, sigma = 10) resolves the motion is not known",
            1,
        ),
        (
            "analyze --force|'1e6*(1-q0^2)*v0 - q0|--q 2 --integrator gauss-legendre-6 --dt 0.01 --steps 100000",
            "gauss-legendre-6 in steps of 0.01 s on force does not resolve the motion over the first",
            1,
        ),
    ] {
        check(words, sentence, code);
    }
}
