//! `cargo xtask size`: lines, public types, functions, kernels and bytes of each crate, beside the recorded ones.

mod libraries;
mod part;
mod record;
mod source_size;

use std::fs;
use std::path::PathBuf;

use self::part::Part;
use self::record::Record;
use crate::tidy::source;
use crate::{Outcome, workspace};

/// The part by which lines or public types may exceed the recorded ones: what one change adds without much thought.
const GROWTH: f64 = 0.005;

/// Prints the sizes of the crates and of the release program beside the recorded ones; with `--record` keeps them.
pub(crate) fn run(arguments: &[String]) -> Outcome {
    let is_recording = match arguments {
        [] => false,
        [flag] if flag == "--record" => true,
        _ => return Err(format!("size takes `--record` or nothing, not {arguments:?}")),
    };
    let mut parts = sources()?;
    let compiled = libraries::of_release_program()?;
    for part in &mut parts {
        part.compiled = compiled.get(&part.name).copied();
    }
    let found = Record { parts };
    if is_recording {
        return fs::write(path(), found.to_string()).map_err(|error| error.to_string());
    }
    print!("{}", found.beside(&recorded()?));
    Ok(())
}

/// Prints lines and public types beside the recorded ones, and fails if they have grown; the rest is as recorded, since it takes a release
/// build.
pub(crate) fn check() -> Outcome {
    let recorded = recorded()?;
    let mut parts = sources()?;
    for part in &mut parts {
        part.compiled = recorded.of(&part.name).and_then(|known| known.compiled);
    }
    let found = Record { parts };
    println!("Functions, kernels and bytes are those that were recorded.");
    print!("{}", found.beside(&recorded));
    found.check_growth(&recorded, GROWTH)
}

fn sources() -> Result<Vec<Part>, String> {
    Ok(source_size::of(&source::tracked(&workspace::root())?))
}

fn path() -> PathBuf {
    workspace::root().join("xtask/size.txt")
}

fn recorded() -> Result<Record, String> {
    let text = fs::read_to_string(path()).map_err(|error| format!("xtask/size.txt: {error}"))?;
    Record::parse(&text)
}
