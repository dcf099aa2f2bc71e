//! `cargo xtask test`: every test of the workspace and of the Python package, on a machine with only Rust and Python.

use std::path::Path;

use crate::suites::{self, Suite};
use crate::{Outcome, command, python, wheel};

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
    // It takes longest: the tests of the package follow it.
    suites.insert(0, wheel::suite(&interpreter)?);
    // It waits for cargo, which builds the wheel meanwhile.
    let examples = command::cargo("test --workspace --doc");
    suites.push(Suite::new("examples in the documentation", examples));
    for suite in &mut suites {
        for each in
            std::iter::once(&mut suite.command).chain(suite.then.iter_mut().map(|s| &mut s.command))
        {
            each.env("LIBRATION_PYTHON", &interpreter);
            if let Some(folder) = report {
                each.env("LIBRATION_REPORT", folder);
            }
        }
    }
    suites::run(suites)
}
