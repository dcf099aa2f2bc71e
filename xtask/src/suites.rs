//! Test programs, several at a time: each alone would leave cores idle while it waits for its slowest test.

use std::collections::VecDeque;
use std::path::PathBuf;
use std::process::Command;
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::Instant;

use serde_json::Value;

use crate::{Outcome, command};

/// The slowest suites, which are started first; the others follow in the order in which they were built.
const LONG: [&str; 6] = ["lab", "cli", "browser", "advise", "engine", "replay"];

/// Something that is run to its end, and what it is called.
pub(crate) struct Suite {
    pub(crate) name: String,
    pub(crate) command: Command,
}

/// Builds all test programs of the workspace, and says how each is run, those that take longest first.
pub(crate) fn built() -> Result<Vec<Suite>, String> {
    command::run(&mut command::cargo("test --workspace --no-run"))?;
    let said = command::output(&mut command::cargo(
        "test --workspace --no-run --quiet --message-format=json",
    ))?;
    let mut suites: Vec<Suite> = said.lines().filter_map(program_in).map(Program::suite).collect();
    suites.sort_by_key(|suite| {
        LONG.iter().position(|name| *name == suite.name).unwrap_or(LONG.len())
    });
    Ok(suites)
}

/// Runs them all, some at a time, and prints what each said when it ends.
///
/// # Errors
/// Names all that failed.
pub(crate) fn run(suites: Vec<Suite>) -> Outcome {
    // One more than there are cores: some wait for a browser.
    let workers = (thread::available_parallelism().map_or(1, usize::from) + 1).min(suites.len());
    let (waiting, failures) = (Mutex::new(VecDeque::from(suites)), Mutex::new(Vec::new()));
    let next = || waiting.lock().unwrap_or_else(PoisonError::into_inner).pop_front();
    thread::scope(|scope| {
        for _ in 0..workers {
            scope.spawn(|| {
                while let Some(mut suite) = next() {
                    let start = Instant::now();
                    let (outcome, said) = command::kept(&mut suite.command);
                    let seconds = start.elapsed().as_secs_f64();
                    println!("\n{said}\n--- {} ended after {seconds:.1} s", suite.name);
                    if let Err(reason) = outcome {
                        failures.lock().unwrap_or_else(PoisonError::into_inner).push(reason);
                    }
                }
            });
        }
    });
    match failures.into_inner().unwrap_or_else(PoisonError::into_inner) {
        failures if failures.is_empty() => Ok(()),
        failures => Err(failures.join("; ")),
    }
}

/// A test program in the output of cargo.
#[derive(Debug, PartialEq)]
struct Program {
    name: String,
    path: PathBuf,
    /// Of its package, where cargo would run it.
    folder: PathBuf,
}

impl Program {
    fn suite(self) -> Suite {
        let mut command = command::program(self.path);
        command.current_dir(&self.folder).env("CARGO_MANIFEST_DIR", self.folder);
        Suite { name: self.name, command }
    }
}

/// The test program that a line of cargo's is about, if it is about one.
fn program_in(line: &str) -> Option<Program> {
    let message: Value = serde_json::from_str(line).ok()?;
    if message["profile"]["test"] != true {
        return None;
    }
    Some(Program {
        name: message["target"]["name"].as_str()?.to_owned(),
        path: PathBuf::from(message["executable"].as_str()?),
        folder: PathBuf::from(message["manifest_path"].as_str()?).parent()?.to_owned(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_programs_of_tests_are_run_each_in_the_folder_of_its_package() {
        let message = |executable: &str, test: bool| {
            format!(
                r#"{{"reason":"compiler-artifact","manifest_path":"/a/b/Cargo.toml","target":{{"name":"lab"}},"profile":{{"test":{test}}},"executable":{executable}}}"#
            )
        };
        let found = program_in(&message("\"/t/lab-1\"", true));
        let wanted = Program { name: "lab".into(), path: "/t/lab-1".into(), folder: "/a/b".into() };
        assert_eq!(found, Some(wanted));
        assert_eq!(program_in(&message("\"/t/libration\"", false)), None);
        assert_eq!(program_in(&message("null", true)), None);
        assert_eq!(program_in("   Compiling libration"), None);
    }

    #[test]
    fn all_are_run_and_all_that_failed_are_named() {
        let suite =
            |arguments: &str| Suite { name: arguments.into(), command: command::cargo(arguments) };
        assert_eq!(run(vec![suite("--version"), suite("--list")]), Ok(()));
        let failed = run(vec![suite("--wrong"), suite("--version"), suite("--false")]).unwrap_err();
        assert!(failed.contains("cargo --wrong") && failed.contains("cargo --false"), "{failed}");
    }
}
