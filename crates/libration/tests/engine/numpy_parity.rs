//! Libration gives the bits of a plain NumPy script, for every integrator in `f64` and `f32`.
//!
//! The script is `../numpy/textbook.py`. The Python to run it is the one that the environment
//! variable `LIBRATION_PYTHON` names, else `target/python/bin/python` of this workspace.

use std::collections::HashMap;
use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;

use libration::system::Oscillator;
use libration::{Float, Method, Model, State};

use super::step_function::step_function;

/// Mass, stiffness, time step, initial position and velocity.
type Setting = [f64; 5];

/// Position and velocity after each number of steps.
type Orbit = Vec<[u64; 2]>;

const STEPS: usize = 100_000;

fn python() -> PathBuf {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().nth(2).unwrap();
    let made = workspace.join("target/python/bin/python");
    let python = env::var_os("LIBRATION_PYTHON").map_or(made, PathBuf::from);
    assert!(
        python.exists(),
        "no Python at {}: run `cargo xtask test`, which makes one with NumPy, or let \
         LIBRATION_PYTHON name one",
        python.display()
    );
    python
}

/// What the script prints.
fn textbook() -> String {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/numpy/textbook.py");
    let output = Command::new(python()).arg(script).output().unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "textbook.py failed:\n{errors}");
    String::from_utf8(output.stdout).unwrap()
}

fn orbit<S: Float>(method: Method, [m, k, dt, q, v]: Setting, bits: fn(S) -> u64) -> Orbit {
    let oscillator = Oscillator::from_mass_and_stiffness(m, k);
    let system = Model::<1>::on::<S>(&oscillator);
    let (start, dt) = (State { q: [q], v: [v] }.map(S::from_f64), S::from_f64(dt));
    let bits = |state: State<S, 1>| [bits(state.q[0]), bits(state.v[0])];
    let step = step_function(method, system, dt);
    let next = |&state: &State<S, 1>| Some(step(state));
    std::iter::successors(Some(start), next).take(STEPS + 1).map(bits).collect()
}

#[test]
fn every_integrator_gives_the_bits_of_the_textbook_in_numpy() {
    let printed = textbook();
    let mut settings: Vec<Setting> = Vec::new();
    let mut orbits: HashMap<(&str, &str, usize), Orbit> = HashMap::new();
    let mut compared: HashMap<(&str, &str), usize> = HashMap::new();
    for line in printed.lines() {
        let words: Vec<&str> = line.split(' ').collect();
        if let ["setting", _, values @ ..] = words.as_slice() {
            let values: Vec<f64> = values.iter().map(|x| x.parse().unwrap()).collect();
            settings.push(values.try_into().unwrap());
            continue;
        }
        let [float, name, setting, step, q, v] = words.as_slice().try_into().unwrap();
        let (setting, step): (usize, usize) = (setting.parse().unwrap(), step.parse().unwrap());
        let orbit = orbits.entry((float, name, setting)).or_insert_with(|| {
            let method = Method::from_name(name).unwrap();
            match float {
                "f64" => orbit::<f64>(method, settings[setting], f64::to_bits),
                "f32" => orbit::<f32>(method, settings[setting], |x| u64::from(x.to_bits())),
                other => panic!("unknown number type {other}"),
            }
        });
        let theirs = [q, v].map(|hex| u64::from_str_radix(hex, 16).unwrap());
        assert_eq!(orbit[step], theirs, "{float}, {name}, setting {setting}, step {step}");
        *compared.entry((float, name)).or_default() += 1;
    }
    for float in ["f64", "f32"] {
        for method in Method::ALL {
            let count = compared.get(&(float, method.name())).copied().unwrap_or(0);
            assert!(count >= 16, "{} on {float}: {count} comparisons", method.name());
        }
    }
}
