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
    libration(z).success().stdout(contains("1/(1 + z²)").and(contains("0 to ∞")));
}

#[test]
fn an_unstable_step_names_the_limit_of_an_implicit_integrator() {
    libration("simulate --system oscillator --set omega2=1 --integrator stable-pd --dt 2 --steps 5000 --save-every 5000")
        .success()
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
