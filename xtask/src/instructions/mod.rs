//! `cargo xtask instructions`: how many instructions a step of the batch kernels takes.
//!
//! A time is noise on a busy machine, and a slowdown of a few per cent hides in it. The number of
//! instructions is the same at every run, so it is compared with the one that was recorded.

mod count;
mod kernel;
mod record;
mod verdict;

use std::fs;
use std::path::Path;

use crate::{Outcome, command, workspace};
use kernel::Kernel;
use record::Recorded;

/// Where the counts are recorded, in the folder of the workspace.
const FILE: &str = "crates/libration/benches/instructions.txt";

const RECORD: &str = "--record";

/// Counts, and fails if a count has risen; with `--record` the counts are written down instead.
pub(crate) fn run(arguments: &[String]) -> Outcome {
    let records = match arguments {
        [] => false,
        [flag] if flag == RECORD => true,
        _ => return Err(format!("expected nothing or `{RECORD}`")),
    };
    if !cfg!(target_arch = "x86_64") {
        return Err("the kernels for AVX2 are compiled on x86-64 only".to_owned());
    }
    count::require_valgrind()?;
    let program = count::build()?;
    let compiler = command::output(command::program("rustc").arg("--version"))?;
    let mut counted = Recorded { compiler: compiler.trim().to_owned(), counts: Vec::new() };
    let path = workspace::root().join(FILE);
    let recorded = match records {
        true => None,
        false => Some(read(&path)?),
    };
    for kernel in Kernel::all() {
        let count = count::per_step(&program, &kernel)?;
        let before = recorded.as_ref().and_then(|recorded| recorded.of(&kernel));
        println!("{}", verdict::line(&kernel, count, before));
        counted.counts.push((kernel.to_string(), count));
    }
    match recorded {
        Some(recorded) => verdict::compare(&recorded, &counted),
        None => fs::write(&path, counted.to_string())
            .map_err(|error| format!("{} cannot be written: {error}", path.display())),
    }
}

fn read(path: &Path) -> Result<Recorded, String> {
    let text = fs::read_to_string(path)
        .map_err(|error| format!("{} cannot be read: {error}", path.display()))?;
    Recorded::parse(&text)
}
