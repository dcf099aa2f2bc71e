//! `cargo xtask test`: every test of the workspace, on a machine with only Rust and Python.

use std::path::Path;

use crate::{Outcome, command, python, wheel};

/// Prepares the Python environment and runs `cargo test --workspace` with `arguments`; without any, the tests of the Python package
/// follow.
pub(crate) fn run(arguments: &[String]) -> Outcome {
    tests(arguments, None)?;
    if arguments.is_empty() { wheel::test(&[]) } else { Ok(()) }
}

/// The same, where the browser opens this report and not one of its own.
pub(crate) fn with_report(folder: &Path) -> Outcome {
    tests(&[], Some(folder))
}

fn tests(arguments: &[String], report: Option<&Path>) -> Outcome {
    let interpreter = python::interpreter()?;
    let mut cargo = command::cargo("test --workspace");
    cargo.args(arguments).env("LIBRATION_PYTHON", interpreter);
    if let Some(folder) = report {
        cargo.env("LIBRATION_REPORT", folder);
    }
    command::run(&mut cargo)
}
