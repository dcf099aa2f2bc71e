//! Lints of code and documentation while the tests are compiled and run.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::{Outcome, command};

/// The compiler through which cargo compiles the crates of the workspace.
const COMPILER: &str = "RUSTC_WORKSPACE_WRAPPER";

/// The program that stands for cargo's `rustdoc` is this one, if it finds here which one it stands for.
const RUSTDOC: &str = "LIBRATION_RUSTDOC";

/// Whether cargo lints what it compiles.
pub(crate) fn are_on() -> bool {
    std::env::var_os(RUSTDOC).is_some()
}

/// Lets cargo lint all that it compiles under `command`: warnings are errors.
///
/// The compiler is the one of `cargo clippy`, with the arguments that it gets there.
pub(crate) fn switch_on(command: &mut Command) -> Result<&mut Command, String> {
    let cargo = std::env::var_os("CARGO").ok_or("cargo has not started this program")?;
    let [clippy, rustdoc] =
        ["clippy-driver", "rustdoc"].map(|name| Path::new(&cargo).with_file_name(name));
    for program in [&clippy, &rustdoc] {
        if !program.exists() {
            return Err(format!("there is no {} beside cargo", program.display()));
        }
    }
    let this = std::env::current_exe().map_err(|error| format!("this program: {error}"))?;
    let arguments = "-Dwarnings__CLIPPY_HACKERY__";
    Ok(command
        .env(COMPILER, clippy)
        .env("CLIPPY_ARGS", arguments)
        .env("RUSTDOC", this)
        .env(RUSTDOC, rustdoc))
}

/// Runs as cargo's `rustdoc`, if this program stands for it: what has examples is documented before they are run.
pub(crate) fn documented(arguments: &[OsString]) -> Option<Outcome> {
    let rustdoc = std::env::var_os(RUSTDOC)?;
    // No name of a task begins like an argument of cargo to rustdoc.
    arguments.first().filter(|first| first.to_string_lossy().starts_with('-'))?;
    let outcome = pages(arguments).map_or(Ok(()), |pages| {
        let mut command = Command::new(&rustdoc);
        command.args(pages).args(["-D", "warnings", "--out-dir"]);
        command::run(command.arg(folder()))
    });
    Some(outcome.and_then(|()| command::run(Command::new(&rustdoc).args(arguments))))
}

/// Where `cargo doc` would put them: beside the folder of this program.
fn folder() -> PathBuf {
    let program = std::env::current_exe().unwrap_or_default();
    program.ancestors().nth(2).unwrap_or(Path::new("target")).join("doc")
}

/// The arguments for the pages of a crate whose examples these run; none if they run none.
fn pages(arguments: &[OsString]) -> Option<Vec<&OsString>> {
    let is_test = |argument: &OsString| argument == "--test";
    arguments.iter().any(is_test).then(|| {
        let mut pages = Vec::new();
        let mut rest = arguments.iter().filter(|argument| !is_test(argument));
        while let Some(argument) = rest.next() {
            let text = argument.to_string_lossy();
            match text.as_ref() {
                "--test-run-directory" | "--test-args" => drop(rest.next()),
                text if text.starts_with("--test-") => {}
                _ => pages.push(argument),
            }
        }
        pages
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pages_are_made_of_what_the_examples_are_made_of() {
        let given = "--edition=2024 --crate-name a --test src/lib.rs --test-run-directory /w -L x --test-args -q";
        let given: Vec<OsString> = given.split(' ').map(OsString::from).collect();
        let pages: Vec<String> =
            pages(&given).unwrap().iter().map(|a| a.to_string_lossy().into_owned()).collect();
        assert_eq!(pages.join(" "), "--edition=2024 --crate-name a src/lib.rs -L x");
        assert!(super::pages(&given[..2]).is_none());
    }
}
