//! Starts and durations of `simulate`, for systems by name and by equations.

use std::fs;

use predicates::str::contains;

use super::simulate::{folder, libration, stdout};

const STEP: &str = "--integrator velocity-verlet --dt 0.05";

/// A falling mass on a spring with a lagging valve.
const VALVE: &str = "[system]\nname = \"valve\"\ncoordinates = [\"x\", \"y\"]\nacceleration.x = \"-4*x + p\"\n\
                     acceleration.y = \"-y + sin(t)\"\nrate.p = \"-p\"\nstart = { x = 1.0 }\n";

#[test]
fn each_way_to_say_a_start_gives_the_same_rows() {
    let folder = folder();
    let text = libration_equations();
    fs::write(folder.path().join("own.toml"), text).unwrap();
    for system in ["pendulum", "own.toml"] {
        let of = |start: &str| {
            stdout(&folder, &format!("simulate --system {system} {start} {STEP} --steps 40"))
        };
        let wanted = of("--q 0.3 --v -0.2");
        assert!(wanted.contains("\n0,0.0,0.3,-0.2,"), "{wanted:.80}");
        for same in
            ["--start q=0.3,q'=-0.2", "--start q'=-0.2 --start q=0.3", "--q 0.3 --start q'=-0.2"]
        {
            assert_eq!(of(same), wanted, "{system} {same}");
        }
        assert_ne!(of("--q 0.3 --v -0.2 --start q=0.31"), wanted);
    }
    let by = |system: &str| {
        stdout(&folder, &format!("simulate --system {system} --q 0.3 --v -0.2 {STEP} --steps 40"))
    };
    assert_eq!(by("pendulum"), by("own.toml"));
}

fn libration_equations() -> &'static str {
    "[system]\nname = \"pendulum\"\ncoordinates = [\"q\"]\nparameters = { omega2 = 9.81 }\nacceleration.q = \"-omega2*sin(q)\"\n\
     energy = \"q'^2/2 + omega2*(1 - cos(q))\"\nstart = { q = 1 }\n"
}

#[test]
fn states_of_first_order_and_time_have_a_start_by_name() {
    let folder = folder();
    fs::write(folder.path().join("valve.toml"), VALVE).unwrap();
    let of = |start: &str| {
        stdout(&folder, &format!("simulate --system valve.toml {start} {STEP} --steps 1"))
    };
    assert!(of("").contains("\n0,0.0,1.0,0.0,0.0,0.0,0.0\n"), "{}", of(""));
    assert!(of("--q 2,3 --v 4,5 --start p=6").contains("\n0,0.0,2.0,3.0,4.0,5.0,6.0\n"));
    // The spring of y adds less than 1e-4 in a step: y reaches 0.00125. A quarter of a turn later the force sin(t) is largest: y' = 0.05·(sin(π/2) + sin(π/2 + 0.05))/2 = 0.049969 from rest.
    let late = of("--start t=1.5707963267948966");
    let last: Vec<f64> =
        late.lines().last().unwrap().split(',').map(|x| x.parse().unwrap()).collect();
    assert!((last[5] - 0.049_968_8).abs() < 1e-4, "{late}");
    for (start, message) in [
        (
            "--start z=1",
            "--start z=1: unknown state `z`; help: the states are `x`, `y`, `x'`, `y'`, `p`",
        ),
        ("--start x=inf", "--start x=inf: expected a finite number"),
        ("--q 1", "--q has 1 numbers; `valve` has 2 coordinates"),
    ] {
        libration(&folder, &format!("simulate --system valve.toml {start} {STEP} --steps 1"))
            .assert()
            .code(2)
            .stderr(contains(message));
    }
    libration(&folder, &format!("simulate --system pendulum --start x=1 {STEP} --steps 1"))
        .assert()
        .code(2)
        .stderr(contains("unknown state `x`; help: the states are `q`, `q'`"));
    // A loop begins where its file says.
    libration(&folder, "simulate --system valve.toml --start x=1 --gain 1,1,1,1 --steps 1")
        .assert()
        .code(2)
        .stderr(contains("--start cannot be combined"));
}

#[test]
fn a_duration_is_the_steps_that_reach_it() {
    let folder = folder();
    let base = format!("simulate --system oscillator {STEP}");
    for (duration, steps) in [("1", 20), ("0.3", 6), ("0.31", 7), ("100ms", 2), ("1min", 1200)] {
        let one = stdout(&folder, &format!("{base} --duration {duration}"));
        assert_eq!(one, stdout(&folder, &format!("{base} --steps {steps}")), "{duration}");
    }
    for (words, message) in [
        ("--duration 0", "--duration 0 s is 0 steps"),
        ("--duration -1", "--duration -1 s is"),
        ("--duration 1e300", "expected"),
        ("--duration 1 --steps 2", "cannot be used with"),
        ("", "--steps"),
        ("--duration 1 --adaptive integrating", "the steps of --adaptive have no equal length"),
    ] {
        let words = format!("{base} {words}");
        libration(&folder, &words).assert().code(2).stderr(contains(message));
    }
    // The step of a loop is its period.
    fs::write(
        folder.path().join("own.toml"),
        libration_equations()
            .replace("acceleration.q = \"", "inputs = [\"u\"]\nacceleration.q = \"u "),
    )
    .unwrap();
    let looped = "simulate --system own.toml --lqr 1,1/1 --period 0.1";
    assert_eq!(
        stdout(&folder, &format!("{looped} --duration 2")),
        stdout(&folder, &format!("{looped} --steps 20"))
    );
}

#[test]
fn linear_equations_of_a_file_have_exact_steps() {
    // x'' = 3 − 4x − 2x' from rest at 0: x = ¾(1 − e^(−t)(cos √3 t + sin √3 t/√3)), by the tables of Laplace transforms.
    let text =
        "[system]\nname = \"step\"\ncoordinates = [\"x\"]\nacceleration.x = \"3 - 4*x - 2*x'\"\n";
    let folder = folder();
    fs::write(folder.path().join("step.toml"), text).unwrap();
    let rows =
        stdout(&folder, "simulate --system step.toml --integrator exact --dt 0.5 --steps 10");
    for row in rows.lines().skip(1) {
        let row: Vec<f64> = row.split(',').map(|x| x.parse().unwrap()).collect();
        let (t, root) = (row[1], 3.0_f64.sqrt());
        let wanted = 0.75 * (1.0 - (-t).exp() * ((root * t).cos() + (root * t).sin() / root));
        // Some roundings of numbers below 1 in each part of each step.
        assert!((row[2] - wanted).abs() < 1e-14, "{row:?}: {wanted}");
    }
    fs::write(folder.path().join("pendulum.toml"), libration_equations()).unwrap();
    libration(&folder, "simulate --system pendulum.toml --integrator exact --dt 0.5 --steps 10")
        .assert()
        .code(2)
        .stderr(contains("--integrator is exact for pendulum; expected another integrator"));
}
