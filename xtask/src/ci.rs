//! `cargo xtask ci`: every check in order, up to the first that fails.

use std::fmt::Write;
use std::thread;
use std::time::{Duration, Instant};

use crate::{Outcome, codegen, command, dependencies, examples, report, test, tidy, wheel};

/// A headline and what stands under it.
type Step = (&'static str, Work);

enum Work {
    /// What is done when its turn comes.
    Now(fn() -> Outcome),
    /// What begins with the step of this name and is waited for when its turn comes; what it says is printed then.
    Beside(&'static str, fn() -> Result<String, String>),
}

use Work::{Beside, Now};

const STEPS: [Step; 10] = [
    ("format", Now(|| command::run(&mut command::cargo("fmt --all --check")))),
    ("tidy", Now(tidy::run)),
    ("dependencies", Now(dependencies::run)),
    (
        "clippy",
        Now(|| {
            command::run(&mut command::cargo("clippy --workspace --all-targets -- -D warnings"))
        }),
    ),
    ("documentation", Now(documentation)),
    ("report", Now(report::run)),
    ("test", Now(|| test::with_report(&report::folder()))),
    ("python", Now(|| wheel::test(&[]))),
    // A compiler on one core for most of the time: beside tests, some of which wait for a browser or for other programs.
    ("codegen", Beside("test", codegen::report)),
    ("examples", Now(examples::run)),
];

/// Runs the steps and prints how long each took.
pub(crate) fn run() -> Outcome {
    let mut durations = Vec::new();
    let mut failure = None;
    let mut beside: [Option<thread::JoinHandle<_>>; STEPS.len()] = Default::default();
    for (i, (name, work)) in STEPS.iter().enumerate() {
        println!("\n=== {} of {}: {name}", i + 1, STEPS.len());
        for (j, (_, work)) in STEPS.iter().enumerate() {
            if let Beside(first, work) = work
                && first == name
            {
                beside[j] = Some(thread::spawn(*work));
            }
        }
        let start = Instant::now();
        let outcome = match (work, beside[i].take()) {
            (Now(work), _) => work(),
            (Beside(..), Some(thread)) => match thread.join() {
                Ok(said) => said.map(|said| print!("{said}")),
                Err(_) => Err("it panicked".to_owned()),
            },
            (Beside(_, work), None) => work().map(|said| print!("{said}")),
        };
        durations.push(start.elapsed());
        let verdict = if outcome.is_ok() { "passed" } else { "failed" };
        println!("--- {name} {verdict} after {:.1} s", start.elapsed().as_secs_f64());
        if let Err(reason) = outcome {
            failure = Some(format!("{name}: {reason}"));
            break;
        }
    }
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
