//! `cargo xtask test`: every test of the workspace and of the Python package, on a machine with only Rust and Python.

use std::path::Path;

use crate::suites::{self, Suite};
use crate::{Outcome, command, python};

/// Prepares the Python environment and runs everything; with `arguments`, nothing but `cargo test --workspace` with them.
pub(crate) fn run(arguments: &[String]) -> Outcome {
    if arguments.is_empty() {
        return all(None);
    }
    let mut cargo = command::cargo("test --workspace");
    command::run(cargo.args(arguments).env("LIBRATION_PYTHON", python::interpreter()?))
}

/// All tests; the browser opens this report, if there is one, and not one of its own.
pub(crate) fn all(report: Option<&Path>) -> Outcome {
    let interpreter = python::interpreter()?;
    let mut suites = suites::built()?;
    let this = std::env::current_exe().map_err(|error| error.to_string())?;
    let mut package = command::program(this);
    package.arg("python");
    // It takes longest: it builds the wheel first.
    suites.insert(0, Suite { name: "the Python package".into(), command: package });
    // It waits for cargo, which builds the wheel meanwhile.
    let examples = command::cargo("test --workspace --doc");
    suites.push(Suite { name: "examples in the documentation".into(), command: examples });
    for suite in &mut suites {
        suite.command.env("LIBRATION_PYTHON", &interpreter);
        if let Some(folder) = report {
            suite.command.env("LIBRATION_REPORT", folder);
        }
    }
    suites::run(suites)
}
