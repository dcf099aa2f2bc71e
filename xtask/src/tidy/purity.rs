//! The engine touches no files, clocks or terminals.

use super::code::{has_word, line_of, words};
use super::finding::Finding;
use super::source::Source;
use crate::workspace;

const MODULES: [&str; 8] = ["env", "fs", "io", "net", "os", "path", "process", "time"];
const NAMES: [&str; 17] = [
    "Instant",
    "_rdtsc",
    "std as",
    "env!",
    "extern crate",
    "include!",
    "include_bytes!",
    "include_str!",
    "option_env!",
    "SystemTime",
    "eprint!",
    "eprintln!",
    "print!",
    "println!",
    "stderr",
    "stdin",
    "stdout",
];
const ADVICE: &str = "the engine reads and prints nothing and knows no clock: return the value, \
                      and let a crate above the engine do it";

/// Doors to the outside world in the sources of the engine.
pub(super) fn check(source: &Source) -> Vec<Finding> {
    if !workspace::in_engine(&source.path) {
        return Vec::new();
    }
    let names = source.code_lines().flat_map(|(number, line)| {
        NAMES.iter().filter(move |name| has_word(line, name)).map(move |name| (number, *name))
    });
    let modules = words(&source.code, "std::").flat_map(|at| {
        let path = standard_path(&source.code[at..]);
        let number = line_of(&source.code, at);
        MODULES.iter().filter(move |name| has_word(path, name)).map(move |name| (number, *name))
    });
    names
        .chain(modules)
        .map(|(number, name)| Finding::new(&source.path, number, format!("`{name}`: {ADVICE}")))
        .collect()
}

/// The names after `std::` in a path: one module, or all in the braces.
fn standard_path(code: &str) -> &str {
    let path = &code["std::".len()..];
    let end = if path.starts_with('{') {
        path.find(';')
    } else {
        path.find(|c: char| !c.is_alphanumeric() && c != '_')
    };
    &path[..end.unwrap_or(path.len())]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(path: &str, text: &str) -> Vec<usize> {
        check(&Source::new(path, text)).iter().map(|finding| finding.place().1).collect()
    }

    #[test]
    fn doors_to_the_outside_are_found() {
        let engine = "crates/libration-core/src/state.rs";
        for module in MODULES {
            assert_eq!(lines(engine, &format!("\nuse std::{module};")), [2]);
            assert_eq!(lines(engine, &format!("use std::{{fmt,\n {module}::*}};")), [1]);
            assert_eq!(lines(engine, &format!("let x = std::{module}::open();")), [1]);
        }
        for name in NAMES {
            assert_eq!(lines(engine, &format!("fn f() {{\n    {name}();\n}}")), [2]);
        }
    }

    #[test]
    fn every_crate_of_the_engine_is_covered() {
        for name in [
            "libration",
            "libration-analysis",
            "libration-batch",
            "libration-core",
            "libration-equations",
            "libration-linear",
            "libration-linear-loops",
        ] {
            for file in ["lib.rs", "a/b.rs"] {
                assert_eq!(lines(&format!("crates/{name}/src/{file}"), "use std::fs;"), [1]);
            }
        }
    }

    #[test]
    fn mathematics_comments_and_other_crates_pass() {
        let engine = "crates/libration-core/src/state.rs";
        assert!(lines(engine, "use std::{array, f64::consts};").is_empty());
        assert!(lines(engine, "/// println!(\"{}\", std::env::args())\nlet time = 0;").is_empty());
        assert!(lines("crates/libration-lab/src/lib.rs", "use std::fs;").is_empty());
        assert!(lines("crates/libration/tests/numpy.rs", "use std::process;").is_empty());
    }
}
