//! Implicit integrators on the command line.

use assert_cmd::Command;
use predicates::prelude::*;
use predicates::str::contains;
use tempfile::TempDir;

const NAMES: [&str; 8] = [
    "damping-implicit",
    "damping-stiffness-implicit",
    "stable-pd",
    "backward-euler",
    "implicit-midpoint",
    "trapezoid",
    "gauss-legendre-4",
    "gauss-legendre-6",
];

fn libration(words: &str) -> assert_cmd::assert::Assert {
    Command::cargo_bin("libration").unwrap().args(words.split_whitespace()).assert()
}

#[test]
fn implicit_integrators_are_listed_simulated_and_analysed() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("pole.toml");
    let text = "[system]\nname = \"pole\"\ncoordinates = [\"x\"]\nacceleration.x = \"-9*sin(x) - 0.1*x'\"\nstart = { x = 0.5 }\n";
    std::fs::write(&file, text).unwrap();
    let file = file.display();
    for name in NAMES {
        libration("list").success().stdout(contains(name));
        for system in ["pendulum", &file.to_string()] {
            let step = format!("--system {system} --integrator {name} --dt 0.01");
            // Of order one at this step some resolve the motion, some do not.
            libration(&format!("analyze {step} --steps 50")).stdout(contains(name));
            libration(&format!("simulate {step} --steps 50 --save-every 50")).success();
            let many = format!(
                "simulate {step} --steps 50 --save-every 50 --num-trajectories 2 --dtype f32"
            );
            libration(&many).success();
        }
    }
    let z = "analyze --system oscillator --integrator backward-euler --dt 0.1 --verbose";
    // This integrator of order one does not resolve the motion.
    libration(z).stdout(contains("1/(1 + z²)").and(contains("0 to ∞")));
}

#[test]
fn an_unstable_step_names_the_limit_of_an_implicit_integrator() {
    libration("simulate --system oscillator --set omega2=1 --integrator stable-pd --dt 2 --steps 5000 --save-every 5000")
        .code(1)
        .stderr(contains("ωΔt = 2 exceeds stable-pd's limit 1.15; choose --dt below 1.15"));
}

#[test]
fn what_takes_no_implicit_integrator_refuses_it_by_name() {
    let step = "--system oscillator --integrator trapezoid --dt 0.01";
    for (words, why) in [
        (format!("analyze {step} --max-drift 0.1"), "--max-drift"),
        (format!("analyze {step} --feedback 10,2"), "--feedback"),
        (format!("simulate {step} --steps 5 --feedback 10,2"), "--feedback"),
        (format!("simulate {step} --steps 5 --jitter gaussian:0.1"), "--jitter"),
    ] {
        libration(&words)
            .code(2)
            .stderr(contains("trapezoid").and(contains(why)).and(contains("expected an explicit")));
    }
}

#[test]
fn coupled_stages_divide_the_most_degrees_of_freedom_of_equations() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("springs.toml");
    let names: Vec<String> = (0..11).map(|i| format!("x{i}")).collect();
    let forces: String = names.iter().map(|x| format!("acceleration.{x} = \"-{x}\"\n")).collect();
    let text = format!("[system]\nname = \"springs\"\ncoordinates = {names:?}\n{forces}");
    std::fs::write(&file, text).unwrap();
    for command in ["analyze", "simulate"] {
        let step = |name: &str| {
            format!("{command} --system {} --integrator {name} --dt 0.1 --steps 2", file.display())
        };
        libration(&step("gauss-legendre-4")).success();
        libration(&step("gauss-legendre-6"))
            .code(2)
            .stderr(contains("gauss-legendre-6").and(contains("10")).and(contains("11")));
    }
}

/// A file with these equations.
fn written(folder: &TempDir, name: &str, equations: &str) -> String {
    let file = folder.path().join(format!("{name}.toml"));
    std::fs::write(&file, format!("[system]\nname = \"{name}\"\n{equations}\n")).unwrap();
    file.display().to_string()
}

/// The root of a rising function between two values.
fn root(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if f(middle) < 0.0 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

#[test]
fn a_step_that_does_not_solve_its_equation_fails_the_run_and_keeps_its_rows() {
    let folder = TempDir::new().unwrap();
    let cubic = written(&folder, "cubic", "rate.x = \"-x^3\"\nstart = { x = 10.0 }");
    // Of x' = −x³ from 10. Backward Euler solves y + h·y³ = 10, the midpoint rule y + h·((10 + y)/2)³ = 10, each with one root.
    type Equation = fn(f64, f64) -> f64;
    let backward: Equation = |y, h| y + h * y.powi(3) - 10.0;
    let midpoint: Equation = |y, h| y + h * (5.0 + 0.5 * y).powi(3) - 10.0;
    for (integrator, equation) in [("backward-euler", backward), ("implicit-midpoint", midpoint)] {
        for dt in [10.0, 3.0, 1.0, 0.3, 0.1, 0.01, 1e-3] {
            let exact = root(|y| equation(y, dt), -100.0, 10.0);
            let words = format!(
                "simulate --system {cubic} --integrator {integrator} --dt {dt} --steps 1 --format json"
            );
            let output = libration(&words);
            let found: serde_json::Value =
                serde_json::from_slice(&output.get_output().stdout).unwrap();
            let end = found["rows"][1][2].as_f64().unwrap();
            // The error of the step as a part of its change: what a further Newton step corrects but for the next one.
            let error = ((end - exact) / (end - 10.0)).abs();
            let residual = found["newton_residual"]["largest"].as_f64().unwrap();
            match error > 1e-6 {
                true => {
                    assert!(
                        residual > 1e-6 && residual < 2.0 * error,
                        "{integrator} {dt}: {residual} {error}"
                    );
                    output.code(1).stderr(contains("did not solve their equations"));
                    assert_eq!(found["verdict"]["outcome"], "exceeds");
                }
                false => {
                    assert!(residual < 1e-6, "{integrator} {dt}: {residual} {error}");
                    output.success();
                    assert_eq!(found["verdict"]["outcome"], "within");
                }
            }
        }
    }
    // Rows in a file are kept: 1.41405 in place of 0.966679.
    let rows = folder.path().join("rows.csv");
    let step = format!("simulate --system {cubic} --integrator backward-euler --dt 10 --steps 1");
    libration(&format!("{step} -q --output {}", rows.display()))
        .code(1)
        .stderr(contains("help: a shorter time step"));
    assert!(std::fs::read_to_string(&rows).unwrap().contains("1.4140"));
}

#[test]
fn unsolved_steps_are_found_in_all_systems_and_solved_ones_are_not_accused() {
    let folder = TempDir::new().unwrap();
    let file = |name: &str, equations: &str| written(&folder, name, equations);
    let cubic = file("cubic", "rate.x = \"-x^3\"\nstart = { x = 10.0 }");
    let steep = file("steep", "rate.x = \"-exp(20*x)\"\nstart = { x = 3.0 }");
    let stiff = file("stiff", "rate.x = \"-1e6*x\"\nstart = { x = 3.0 }");
    let hit = file(
        "hit",
        "coordinates = [\"x\"]\nacceleration.x = \"-x - 1e6*max(x - 1, 0)\"\nstart = { x = 0.9, \"x'\" = 5.0 }",
    );
    let relaxation = file(
        "relaxation",
        "coordinates = [\"x\"]\nacceleration.x = \"1000*(1 - x^2)*x' - x\"\nstart = { x = 1.001, \"x'\" = -10.0 }",
    );
    for (step, is_solved) in [
        (format!("{cubic} --integrator trapezoid --dt 10"), false),
        (format!("{cubic} --integrator gauss-legendre-4 --dt 10"), false),
        (format!("{cubic} --integrator gauss-legendre-6 --dt 10"), false),
        (format!("{steep} --integrator backward-euler --dt 1"), false),
        (format!("{relaxation} --integrator implicit-midpoint --dt 0.05"), false),
        ("pendulum --q 2 --integrator implicit-midpoint --dt 5".to_owned(), false),
        ("kepler --q 1,0 --v 0,0.1 --integrator backward-euler --dt 0.5".to_owned(), false),
        (format!("{cubic} --integrator backward-euler --dt 10 --num-trajectories 3"), false),
        ("pendulum --q 2 --integrator implicit-midpoint --dt 5 --num-trajectories 3 --save-every 5".to_owned(), false),
        // One Newton step is exact on linear systems, whatever the step.
        (format!("{stiff} --integrator backward-euler --dt 10"), true),
        ("oscillator --integrator gauss-legendre-6 --dt 3".to_owned(), true),
        ("damped-oscillator --integrator trapezoid --dt 3".to_owned(), true),
        // Rounding is no residual, in any float type.
        ("pendulum --q 2 --integrator implicit-midpoint --dt 1e-4".to_owned(), true),
        ("pendulum --q 2 --integrator backward-euler --dt 0.01 --dtype f32".to_owned(), true),
        ("pendulum --q 2 --integrator gauss-legendre-4 --dt 0.01 --dtype bf16".to_owned(), true),
        ("kepler --integrator gauss-legendre-6 --dt 0.05".to_owned(), true),
        ("kepler --integrator gauss-legendre-6 --dt 0.05 --num-trajectories 4".to_owned(), true),
        // A start at rest, and one that never moves.
        ("pendulum --q 0 --v 0 --integrator trapezoid --dt 0.1".to_owned(), true),
        (format!("{hit} --integrator backward-euler --dt 1e-5"), true),
    ] {
        let output = libration(&format!("simulate --system {step} --steps 200"));
        match is_solved {
            true => output.success(),
            false => output.code(1).stderr(contains("did not solve their equations")),
        };
    }
}

#[test]
fn no_list_promises_an_unlimited_step_on_every_system() {
    let output = libration("list").success().get_output().stdout.clone();
    let text = String::from_utf8_lossy(&output).into_owned();
    let words: Vec<&str> = text.split_whitespace().collect();
    let text = words.join(" ");
    assert!(text.contains("no limit of the step on linear systems"), "{text}");
    assert!(!text.contains("without a limit of the step"), "{text}");
}
