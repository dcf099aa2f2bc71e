//! `cargo xtask ci`: every check in order, up to the first that fails.

use std::fmt::Write;
use std::thread;
use std::time::{Duration, Instant};

use crate::{Outcome, codegen, command, dependencies, examples, python, report, test, tidy};

/// Name and function of a step.
type Step = (&'static str, fn() -> Outcome);

const STEPS: [Step; 9] = [
    ("format", || command::run(&mut command::cargo("fmt --all --check"))),
    ("tidy", tidy::run),
    ("dependencies", dependencies::run),
    ("codegen", codegen::unless_read),
    ("clippy", || {
        command::run(&mut command::cargo("clippy --workspace --all-targets -- -D warnings"))
    }),
    ("documentation", documentation),
    ("report", report::run),
    ("test", || test::all(Some(&report::folder()))),
    ("examples", examples::run),
];

/// Runs the steps and prints how long each took.
pub(crate) fn run() -> Outcome {
    // Nothing but the tests needs the packages, which take a while to install: they say what failed.
    let packages = thread::spawn(|| python::interpreter().is_ok());
    let mut durations = Vec::new();
    let mut failure = None;
    for (i, (name, work)) in STEPS.iter().enumerate() {
        println!("\n=== {} of {}: {name}", i + 1, STEPS.len());
        let start = Instant::now();
        let outcome = work();
        durations.push(start.elapsed());
        let verdict = if outcome.is_ok() { "passed" } else { "failed" };
        println!("--- {name} {verdict} after {:.1} s", start.elapsed().as_secs_f64());
        if let Err(reason) = outcome {
            failure = Some(format!("{name}: {reason}"));
            break;
        }
    }
    // Not to be left half installed; the tests have told what is wrong with them.
    let _ = packages.join();
    print!("\n{}", summary(&STEPS.map(|(name, _)| name), &durations, failure.is_some()));
    failure.map_or(Ok(()), Err)
}

fn documentation() -> Outcome {
    let flags = std::env::var("RUSTDOCFLAGS").unwrap_or_default();
    let flags = format!("{flags} -D warnings");
    command::run(
        command::cargo("doc --workspace --no-deps").env("RUSTDOCFLAGS", flags.trim_start()),
    )
}

/// The table at the end; steps without a duration did not run, the last with one may have failed.
fn summary(names: &[&str], durations: &[Duration], failed: bool) -> String {
    let mut table = String::new();
    for (i, name) in names.iter().enumerate() {
        let verdict = match i + 1 {
            n if n > durations.len() => "not run",
            n if n == durations.len() && failed => "FAILED",
            _ => "passed",
        };
        let seconds =
            durations.get(i).map_or(String::new(), |d| format!("{:.1} s", d.as_secs_f64()));
        // Writing to a string cannot fail.
        let _ = writeln!(table, "{name:<16}{verdict:<10}{seconds:>9}");
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_summary_names_what_failed_and_what_did_not_run() {
        let durations = [Duration::from_millis(1500), Duration::from_secs(61)];
        let table = summary(&["format", "tidy", "test"], &durations, true);
        assert_eq!(
            table,
            "format          passed        1.5 s\n\
             tidy            FAILED       61.0 s\n\
             test            not run            \n"
        );
        assert!(
            summary(&["format", "tidy"], &durations, false).lines().all(|l| l.contains("passed"))
        );
    }
}
