//! `cargo xtask ci`: every check in order, up to the first that fails.

use std::fmt::Write;
use std::thread;
use std::time::{Duration, Instant};

use crate::{
    Outcome, codegen, command, dependencies, lints, processor_time, python, size, test, tidy,
};

/// Name and function of a step.
type Step = (&'static str, fn() -> Outcome);

const STEPS: [Step; 7] = [
    ("format", || command::run(&mut command::cargo("fmt --all --check"))),
    ("tidy", tidy::run),
    ("size", size::check),
    ("dependencies", dependencies::run),
    ("codegen", codegen::unless_read),
    ("lints", || command::run(&mut command::cargo("test --workspace --no-run"))),
    ("tests", || test::all(true)),
];

/// Runs the steps under the lints, in a program of its own.
///
/// Whatever cargo compiles for the tests is linted on the way, and its documentation is checked with the examples in it: a check of its own
/// would read all dependencies and crates once more.
pub(crate) fn run() -> Outcome {
    if lints::are_on() {
        return steps();
    }
    let program = std::env::current_exe().map_err(|error| format!("this program: {error}"))?;
    command::run(lints::switch_on(command::program(program).arg("ci"))?)
}

/// Runs the steps and prints what each cost.
fn steps() -> Outcome {
    // Nothing but the tests needs the packages, which take a while to install: they say what failed.
    let packages = thread::spawn(|| python::interpreter().is_ok());
    let mut costs = Vec::new();
    let mut failure = None;
    for (i, (name, work)) in STEPS.iter().enumerate() {
        println!("\n=== {} of {}: {name}", i + 1, STEPS.len());
        let (start, processor) = (Instant::now(), processor_time::of_children());
        let outcome = work();
        costs.push([start.elapsed(), processor_time::of_children() - processor]);
        let verdict = if outcome.is_ok() { "passed" } else { "failed" };
        println!("--- {name} {verdict} after {:.1} s", start.elapsed().as_secs_f64());
        if let Err(reason) = outcome {
            failure = Some(format!("{name}: {reason}"));
            break;
        }
    }
    // Not to be left half installed; the tests have told what is wrong with them.
    let _ = packages.join();
    print!("\n{}", summary(&STEPS.map(|(name, _)| name), &costs, failure.is_some()));
    failure.map_or(Ok(()), Err)
}

/// The table at the end, with the duration and the processor time of each step.
///
/// Steps without costs did not run; the last with them may have failed. The installation of packages counts for the steps during which its
/// programs end.
fn summary(names: &[&str], costs: &[[Duration; 2]], failed: bool) -> String {
    let seconds = |time: Duration| format!("{:.1} s", time.as_secs_f64());
    let mut table = format!("{:<26}{:>9}{:>11}\n", "step", "duration", "processor");
    for (i, name) in names.iter().enumerate() {
        let verdict = match i + 1 {
            n if n > costs.len() => "not run",
            n if n == costs.len() && failed => "FAILED",
            _ => "passed",
        };
        let [duration, processor] =
            costs.get(i).map_or([String::new(), String::new()], |both| both.map(seconds));
        // Writing to a string cannot fail.
        let _ = writeln!(table, "{name:<16}{verdict:<10}{duration:>9}{processor:>11}");
    }
    let sum = |i: usize| seconds(costs.iter().map(|both| both[i]).sum());
    let _ = writeln!(table, "{:<26}{:>9}{:>11}", "all steps", sum(0), sum(1));
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_summary_names_what_failed_and_what_did_not_run() {
        let costs = [[1500, 2000], [61_000, 120_000]].map(|both| both.map(Duration::from_millis));
        let table = summary(&["format", "tidy", "test"], &costs, true);
        assert_eq!(
            table,
            "step                       duration  processor\n\
             format          passed        1.5 s      2.0 s\n\
             tidy            FAILED       61.0 s    120.0 s\n\
             test            not run                       \n\
             all steps                    62.5 s    122.0 s\n"
        );
        assert!(!summary(&["format", "tidy"], &costs, false).contains("FAILED"));
    }
}
