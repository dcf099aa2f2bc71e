//! Test programs, several at a time: each alone would leave cores idle while it waits for its slowest test.

use std::cmp::Reverse;
use std::collections::VecDeque;
use std::path::PathBuf;
use std::process::Command;
use std::sync::{Condvar, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::{Outcome, command};

/// The slowest suites, which are started first; the others follow in the order in which they were built.
const LONG: [&str; 10] = [
    "cli",
    "lab",
    "advise",
    "browser",
    EXAMPLES_IN_DOCUMENTATION,
    "identify",
    "analyze",
    "engine",
    EXAMPLES,
    "libration_analysis",
];

/// The name of the suite of the examples in the documentation.
pub(crate) const EXAMPLES_IN_DOCUMENTATION: &str = "examples in the documentation";

/// The name of the suite of the examples.
pub(crate) const EXAMPLES: &str = "examples";

/// Something that is run to its end, and what it is called.
pub(crate) struct Suite {
    pub(crate) name: String,
    pub(crate) command: Command,
    /// Suites that need what this one makes. They are run only if it passes, and before all others that wait.
    pub(crate) then: Vec<Suite>,
}

impl Suite {
    pub(crate) fn new(name: impl Into<String>, command: Command) -> Self {
        Self { name: name.into(), command, then: Vec::new() }
    }
}

/// Builds all test programs of the workspace, and says how each is run.
pub(crate) fn built() -> Result<Vec<Suite>, String> {
    command::run(&mut command::cargo("test --workspace --no-run"))?;
    let said = command::output(&mut command::cargo(
        "test --workspace --no-run --quiet --message-format=json",
    ))?;
    Ok(said.lines().filter_map(program_in).map(Program::suite).collect())
}

/// Brings those that take longest to the front.
pub(crate) fn sort(suites: &mut [Suite]) {
    suites.sort_by_key(|suite| {
        LONG.iter().position(|name| *name == suite.name).unwrap_or(LONG.len())
    });
}

/// What a suite took.
struct Cost {
    name: String,
    duration: Duration,
    processor: Duration,
}

/// Suites that wait, and how many run that others follow.
struct Queue {
    waiting: VecDeque<Suite>,
    ahead: usize,
}

/// Runs them all, some at a time, and prints what each said when it ends, and at last what each cost.
///
/// # Errors
/// Names all that failed.
pub(crate) fn run(suites: Vec<Suite>) -> Outcome {
    // More than there are cores: some wait for a browser, a disk or other programs.
    let workers = thread::available_parallelism().map_or(1, usize::from) + 2;
    let queue = Mutex::new(Queue { waiting: VecDeque::from(suites), ahead: 0 });
    let (changed, results) = (Condvar::new(), Mutex::new(Vec::new()));
    thread::scope(|scope| {
        for _ in 0..workers {
            scope.spawn(|| {
                while let Some(mut suite) = next(&queue, &changed) {
                    let start = Instant::now();
                    let ended = command::kept(&mut suite.command, command::LONGEST);
                    let cost = Cost {
                        name: suite.name,
                        duration: start.elapsed(),
                        processor: ended.processor,
                    };
                    println!("\n{}\n--- {} ended after {}", ended.said, cost.name, shown(&cost));
                    if !suite.then.is_empty() {
                        let mut queue = queue.lock().unwrap_or_else(PoisonError::into_inner);
                        queue.ahead -= 1;
                        if ended.outcome.is_ok() {
                            suite.then.into_iter().rev().for_each(|s| queue.waiting.push_front(s));
                        }
                        changed.notify_all();
                    }
                    let mut results = results.lock().unwrap_or_else(PoisonError::into_inner);
                    results.push((cost, ended.outcome));
                }
            });
        }
    });
    let results = results.into_inner().unwrap_or_else(PoisonError::into_inner);
    let (costs, outcomes): (Vec<Cost>, Vec<Outcome>) = results.into_iter().unzip();
    print!("\n{}", table(costs));
    let failures: Vec<String> = outcomes.into_iter().filter_map(Outcome::err).collect();
    if failures.is_empty() { Ok(()) } else { Err(failures.join("; ")) }
}

/// The suite to run next; waits while one runs that others follow.
fn next(queue: &Mutex<Queue>, changed: &Condvar) -> Option<Suite> {
    let mut queue = queue.lock().unwrap_or_else(PoisonError::into_inner);
    loop {
        if let Some(suite) = queue.waiting.pop_front() {
            queue.ahead += usize::from(!suite.then.is_empty());
            return Some(suite);
        }
        if queue.ahead == 0 {
            return None;
        }
        queue = changed.wait(queue).unwrap_or_else(PoisonError::into_inner);
    }
}

fn shown(cost: &Cost) -> String {
    let [duration, processor] = [cost.duration, cost.processor].map(|time| time.as_secs_f64());
    format!("{duration:.1} s, {processor:.1} s of processor")
}

/// What each suite cost, those that cost most first, and the sum.
fn table(mut costs: Vec<Cost>) -> String {
    costs.sort_by_key(|cost| Reverse(cost.processor));
    let sum = costs.iter().map(|cost| cost.processor).sum::<Duration>();
    let line = |name: &str, duration: String, processor: Duration| {
        format!("{name:<44}{duration:>9}{:>9.1} s\n", processor.as_secs_f64())
    };
    let lines = costs.iter().map(|cost| {
        line(&cost.name, format!("{:.1} s", cost.duration.as_secs_f64()), cost.processor)
    });
    let head = format!("{:<44}{:>9}{:>11}\n", "suite", "duration", "processor");
    head + &lines.collect::<String>() + &line("all suites", String::new(), sum)
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
        Suite::new(self.name, command)
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
        let suite = |arguments: &str| Suite::new(arguments, command::cargo(arguments));
        assert_eq!(run(vec![suite("--version"), suite("--list")]), Ok(()));
        let failed = run(vec![suite("--wrong"), suite("--version"), suite("--false")]).unwrap_err();
        assert!(failed.contains("cargo --wrong") && failed.contains("cargo --false"), "{failed}");
    }

    #[test]
    fn suites_that_follow_another_are_run_only_if_it_passes() {
        let first = |arguments: &str| {
            let then = vec![Suite::new("later", command::cargo("--later"))];
            vec![Suite { then, ..Suite::new("first", command::cargo(arguments)) }]
        };
        let failed = run(first("--version")).unwrap_err();
        assert!(failed.contains("cargo --later"), "{failed}");
        let failed = run(first("--wrong")).unwrap_err();
        assert!(failed.contains("cargo --wrong") && !failed.contains("--later"), "{failed}");
    }

    #[test]
    fn the_table_begins_with_what_costs_most_and_ends_with_the_sum() {
        let cost = |name: &str, duration, processor| Cost {
            name: name.to_owned(),
            duration: Duration::from_millis(duration),
            processor: Duration::from_millis(processor),
        };
        let table = table(vec![cost("a", 2000, 500), cost("b", 1000, 1500)]);
        let rows: Vec<Vec<&str>> =
            table.lines().map(|line| line.split_whitespace().collect()).collect();
        assert_eq!(rows[1], ["b", "1.0", "s", "1.5", "s"]);
        assert_eq!(rows[2], ["a", "2.0", "s", "0.5", "s"]);
        assert_eq!(rows[3], ["all", "suites", "2.0", "s"]);
    }
}
