//! Systems by equations: the examples against SciPy, and their conserved energies.

#![allow(clippy::unwrap_used)]

mod narrow_forces;
mod oscillators;
mod step_matrices;
mod verdicts;

use std::fs;
use std::path::{Path, PathBuf};

use libration::Method;
use libration::equations::{Degree, StepProgram};
use libration_settings::equations::EquationSystem;
use serde_json::Value;

fn examples() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/systems")
}

fn read(name: &str) -> EquationSystem {
    let path = examples().join(format!("{name}.toml"));
    let text = fs::read_to_string(&path).unwrap_or_else(|error| panic!("{name}: {error}"));
    EquationSystem::parse(&text, name, &[]).unwrap_or_else(|error| panic!("{error}"))
}

/// Positions, velocities and states of first order after `steps` steps of RK4 to the time `end`, and the change of the energy.
fn simulate(system: &EquationSystem, end: f64, steps: u32) -> (Vec<f64>, Option<f64>) {
    let equations = &system.equations;
    let program = StepProgram::new(Method::Rk4, equations.dynamics());
    let mut step = program.program().on::<f64>();
    let mut inputs: Vec<f64> = system.q.iter().chain(&system.v).copied().collect();
    let states = inputs.len();
    inputs.resize(states + equations.inputs().len(), 0.0);
    inputs.push(end / f64::from(steps));
    let energy = |inputs: &[f64]| {
        equations.dynamics().energy().and_then(|energy| energy.on::<f64>().run(inputs).next())
    };
    let before = energy(&inputs);
    for _ in 0..steps {
        let next: Vec<f64> = step.run(&inputs).collect();
        inputs[..states].copy_from_slice(&next);
    }
    let change = before.zip(energy(&inputs)).map(|(before, after)| after - before);
    let d = equations.degrees().len();
    let shown = (0..states).filter(|i| match equations.degrees()[i % d] {
        Degree::Coordinate(_) => true,
        Degree::State(_) => *i >= d,
        Degree::Time => false,
    });
    (shown.map(|i| inputs[i]).collect(), change)
}

#[test]
fn the_examples_agree_with_scipy_and_keep_their_energies() {
    let reference = include_str!("dop853.json");
    let reference: Value = serde_json::from_str(reference).unwrap();
    let runs = reference["runs"].as_array().unwrap();
    assert_eq!(runs.len(), fs::read_dir(examples()).unwrap().count());
    for run in runs {
        let name = run["system"].as_str().unwrap();
        let system = read(name);
        let end = run["end"].as_f64().unwrap();
        let (coarse, _) = simulate(&system, end, 50_000);
        let (fine, change) = simulate(&system, end, 100_000);
        for (i, wanted) in run["state"].as_array().unwrap().iter().enumerate() {
            let wanted = wanted.as_f64().unwrap();
            // A halved step leaves a fifteenth of this difference; rounding and SciPy's own error of 10⁻¹³ grow with the motion.
            let allowed = (fine[i] - coarse[i]).abs() + 1e-9 * wanted.abs().max(1e-3);
            assert!((fine[i] - wanted).abs() <= allowed, "{name} {i}: {} {wanted}", fine[i]);
        }
        if let Some(change) = change {
            assert!(change.abs() < 1e-9, "{name}: the energy changes by {change:e}");
        }
    }
}
