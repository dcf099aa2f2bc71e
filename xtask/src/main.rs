//! Everything that continuous integration does, as tasks: `cargo xtask` lists them.

mod ci;
mod codegen;
mod command;
mod dependencies;
mod examples;
mod instructions;
mod licenses;
mod lints;
mod live;
mod processor_time;
mod python;
mod release;
mod report;
mod scratch;
mod size;
mod suites;
mod test;
mod tidy;
mod torture;
mod wheel;
mod workspace;

use std::ffi::OsString;
use std::process::ExitCode;

/// Result of a task: nothing, or an error message.
type Outcome = Result<(), String>;

struct Task {
    name: &'static str,
    summary: &'static str,
    action: Action,
}

/// A task.
enum Action {
    /// Without arguments.
    Plain(fn() -> Outcome),
    /// With the arguments behind its name.
    With(fn(&[String]) -> Outcome),
}

const TASKS: [Task; 15] = [
    Task {
        name: "ci",
        summary: "all of the below up to `report`, with format, lints and documentation",
        action: Action::Plain(ci::run),
    },
    Task {
        name: "tidy",
        summary: "source rules that no compiler checks",
        action: Action::Plain(tidy::run),
    },
    Task {
        name: "dependencies",
        summary: "the engine depends on listed crates only, tests compile none twice, and licenses are listed",
        action: Action::Plain(dependencies::run),
    },
    Task {
        name: "codegen",
        summary: "every batch kernel is made of vectors, read from its assembly",
        action: Action::Plain(codegen::run),
    },
    Task {
        name: "live",
        summary: "compiles the engine of live pages to WebAssembly, into the assets of the report",
        action: Action::Plain(live::build),
    },
    Task {
        name: "test",
        summary: "all tests, with a Python environment and the wheel; with arguments `cargo test` alone",
        action: Action::With(test::run),
    },
    Task {
        name: "wheel",
        summary: "builds the wheel of the Python package and installs it into target/python",
        action: Action::Plain(wheel::install),
    },
    Task {
        name: "python",
        summary: "the wheel of the Python package and its tests; arguments go to pytest",
        action: Action::With(wheel::test),
    },
    Task {
        name: "examples",
        summary: "builds every example and runs it; with `built` those that are there",
        action: Action::With(|given| on_built(given, examples::run, examples::run_built)),
    },
    Task {
        name: "report",
        summary: "a quick `libration lab` and its files checked; with `built` of the program that is there",
        action: Action::With(|given| on_built(given, report::run, report::run_built)),
    },
    Task {
        name: "licenses",
        summary: "writes THIRD-PARTY-LICENSES.txt, which the wheel contains",
        action: Action::Plain(licenses::write),
    },
    Task {
        name: "release",
        summary: "a source distribution and a Linux wheel of the Python package, checked and tried",
        action: Action::Plain(release::run),
    },
    Task {
        name: "size",
        summary: "lines, public types, functions, kernels and bytes of each crate; `--record` keeps them",
        action: Action::With(size::run),
    },
    Task {
        name: "torture",
        summary: "processes that write data sets and replay buffers are killed, fifty times each",
        action: Action::Plain(torture::run),
    },
    Task {
        name: "instructions",
        summary: "instructions of the batch kernels under valgrind; `--record` keeps them",
        action: Action::With(instructions::run),
    },
];

fn main() -> ExitCode {
    let given: Vec<OsString> = std::env::args_os().skip(1).collect();
    if let Some(outcome) = lints::documented(&given) {
        return ended("as rustdoc", outcome);
    }
    let arguments: Vec<String> =
        given.iter().map(|argument| argument.to_string_lossy().into_owned()).collect();
    let (name, rest) = match arguments.split_first() {
        Some((name, rest)) if !["help", "-h", "--help"].contains(&name.as_str()) => (name, rest),
        _ => {
            print!("{}", usage());
            return ExitCode::SUCCESS;
        }
    };
    let outcome = match TASKS.iter().find(|task| task.name == name).map(|task| &task.action) {
        Some(Action::With(run)) => run(rest),
        Some(Action::Plain(run)) if rest.is_empty() => run(),
        Some(Action::Plain(_)) => return misuse(&format!("`{name}` takes no arguments")),
        None => return misuse(&format!("there is no task `{name}`")),
    };
    ended(name, outcome)
}

/// Runs a task, or with the argument [`test::BUILT`] the part of it that follows the build.
fn on_built(given: &[String], all: fn() -> Outcome, rest: fn() -> Outcome) -> Outcome {
    match given {
        [] => all(),
        [word] if word == test::BUILT => rest(),
        _ => Err(format!("unknown arguments `{}`; expected none or `built`", given.join(" "))),
    }
}

fn ended(name: &str, outcome: Outcome) -> ExitCode {
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(reason) => {
            eprintln!("xtask {name}: {reason}");
            ExitCode::FAILURE
        }
    }
}

fn usage() -> String {
    let tasks = TASKS.map(|task| format!("  {:<14}{}\n", task.name, task.summary));
    format!("Usage: cargo xtask <task>\n\n{}", tasks.concat())
}

fn misuse(complaint: &str) -> ExitCode {
    eprint!("xtask: {complaint}\n\n{}", usage());
    ExitCode::from(2)
}
