//! `cargo xtask test`: every test of the workspace, on a machine with only Rust and Python.

use crate::{Outcome, command, python};

/// Prepares the Python environment, then runs `cargo test --workspace` with `arguments`.
pub(crate) fn run(arguments: &[String]) -> Outcome {
    let interpreter = python::interpreter()?;
    command::run(
        command::cargo("test --workspace").args(arguments).env("LIBRATION_PYTHON", interpreter),
    )
}
