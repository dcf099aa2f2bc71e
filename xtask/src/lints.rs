//! Lints of code and documentation while the tests are compiled and run.

use std::ffi::OsString;
use std::fs;
use std::path::Path;
use std::process::Command;

use crate::scratch::Scratch;
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

/// Runs as cargo's `rustdoc`, if this program stands for it: a crate is documented before its examples are run, if it has any.
pub(crate) fn documented(arguments: &[OsString]) -> Option<Outcome> {
    let rustdoc = std::env::var_os(RUSTDOC)?;
    // No name of a task begins like an argument of cargo to rustdoc.
    arguments.first().filter(|first| first.to_string_lossy().starts_with('-'))?;
    let outcome = pages(arguments).map_or(Ok(()), |pages| {
        // In a folder of all crates each would write the index of all once more.
        let folder = Scratch::new("pages")?;
        let mut command = Command::new(&rustdoc);
        command.args(pages).args(["-D", "warnings", "--out-dir"]);
        command::run(command.arg(folder.path()))
    });
    let is_source =
        |argument: &&OsString| Path::new(argument).extension().is_some_and(|e| e == "rs");
    let source = arguments.iter().find(is_source).and_then(|file| Path::new(file).parent());
    if source.is_some_and(|folder| !may_have_examples(folder)) {
        return Some(outcome);
    }
    Some(outcome.and_then(|()| command::run(Command::new(&rustdoc).args(arguments))))
}

/// Whether a source in the folder has a fence, or documentation from another file. To look for examples, the compiler would read the crate once more.
fn may_have_examples(folder: &Path) -> bool {
    let Ok(entries) = fs::read_dir(folder) else { return true };
    entries.flatten().map(|entry| entry.path()).any(|path| match path.is_dir() {
        true => may_have_examples(&path),
        false => fs::read_to_string(&path)
            .map_or(true, |text| text.contains("```") || text.contains("doc = include_str!")),
    })
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
    fn crates_without_fences_have_no_examples() {
        let scratch = Scratch::new("fences").unwrap();
        let folder = scratch.path();
        let write = |name: &str, text: &str| fs::write(folder.join(name), text).unwrap();
        fs::create_dir_all(folder.join("inner")).unwrap();
        write("lib.rs", "//! Text.");
        assert!(!may_have_examples(folder));
        write("inner/one.rs", "/// ```\n/// let one = 1;");
        assert!(may_have_examples(folder));
        assert!(may_have_examples(&folder.join("missing")));
    }

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
