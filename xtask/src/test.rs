//! `cargo xtask test`: every test of the workspace and of the Python package, on a machine with only Rust and Python.

use std::process::Command;

use crate::suites::{self, Suite};
use crate::{Outcome, command, python, report, wheel};

/// Prepares the Python environment and runs everything; with `arguments`, nothing but `cargo test --workspace` with them.
pub(crate) fn run(arguments: &[String]) -> Outcome {
    if arguments.is_empty() {
        return all(false);
    }
    let mut cargo = command::cargo("test --workspace");
    command::run(cargo.args(arguments).env("LIBRATION_PYTHON", python::interpreter()?))
}

/// All tests. In continuous integration also the examples, and a report that tests look at, where otherwise they make their own.
pub(crate) fn all(in_ci: bool) -> Outcome {
    let interpreter = python::interpreter()?;
    let mut suites = suites::built()?;
    let documentation = command::cargo("test --workspace --doc");
    suites.push(Suite::new(suites::EXAMPLES_IN_DOCUMENTATION, documentation));
    if in_ci {
        suites.push(Suite::new(suites::EXAMPLES, task(["examples", BUILT])?));
    }
    suites::sort(&mut suites);
    if in_ci {
        let (readers, others) =
            suites.into_iter().partition(|suite| looks_at_a_report(&suite.name));
        suites = others;
        let report = Suite::new("the report", task(["report", BUILT])?);
        suites.insert(0, Suite { then: readers, ..report });
    }
    // It takes longest: the tests of the package follow it.
    suites.insert(0, wheel::suite(&interpreter)?);
    for suite in &mut suites {
        for each in
            std::iter::once(&mut suite.command).chain(suite.then.iter_mut().map(|s| &mut s.command))
        {
            each.env("LIBRATION_PYTHON", &interpreter);
            if in_ci {
                each.env("LIBRATION_REPORT", report::folder());
            }
        }
    }
    suites::run(suites)
}

/// The argument of a task whose programs are there already: cargo, which builds the wheel meanwhile, would let it wait.
pub(crate) const BUILT: &str = "built";

fn looks_at_a_report(suite: &str) -> bool {
    ["lab", "browser"].contains(&suite)
}

/// A task of this program as a program of its own.
fn task(arguments: [&str; 2]) -> Result<Command, String> {
    let program = std::env::current_exe().map_err(|error| format!("this program: {error}"))?;
    let mut task = command::program(program);
    task.args(arguments);
    Ok(task)
}
