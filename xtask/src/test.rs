//! `cargo xtask test`: every test of the workspace, on a machine with only Rust and Python.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::thread;

use crate::examples::programs_in;
use crate::{Outcome, command, python, workspace};

/// Tests that wait for a browser more than they work.
const WAITING: &str = "browser";

/// Prepares the Python environment, then runs `cargo test --workspace` with `arguments`.
pub(crate) fn run(arguments: &[String]) -> Outcome {
    command::run(prepared(None)?.args(arguments))
}

/// The same, where the browser opens this report and not one of its own, beside all other tests.
pub(crate) fn with_report(folder: &Path) -> Outcome {
    let cargo = || prepared(Some(folder));
    command::run(cargo()?.arg("--no-run"))?;
    let mut waiting = cargo()?;
    waiting.args(["--test", WAITING]);
    let browser = thread::spawn(move || command::output(&mut waiting));
    let mut others = cargo()?;
    others.args(["--lib", "--bins"]);
    for name in integration_tests().iter().filter(|name| *name != WAITING) {
        others.args(["--test", name]);
    }
    let mut outcome = command::run(&mut others);
    outcome = outcome.and(command::run(cargo()?.arg("--doc")));
    let said = browser.join().map_err(|_| "the tests of the browser panicked".to_owned())?;
    said.map(|said| print!("{said}")).and(outcome)
}

/// `cargo test --workspace`, with what the tests need.
fn prepared(report: Option<&Path>) -> Result<Command, String> {
    let mut cargo = command::cargo("test --workspace");
    cargo.env("LIBRATION_PYTHON", python::interpreter()?);
    if let Some(folder) = report {
        cargo.env("LIBRATION_REPORT", folder);
    }
    Ok(cargo)
}

/// The names of all tests that are programs of their own.
fn integration_tests() -> Vec<String> {
    let crates = fs::read_dir(workspace::root().join("crates")).into_iter().flatten().flatten();
    let mut names: Vec<String> =
        crates.flat_map(|folder| programs_in(&folder.path().join("tests"))).collect();
    names.sort();
    names.dedup();
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_program_of_tests_is_found() {
        let names = integration_tests();
        for name in ["analysis", "browser", "cli", "lab", "loops", "rl"] {
            assert!(names.iter().any(|found| found == name), "{name} {names:?}");
        }
    }
}
