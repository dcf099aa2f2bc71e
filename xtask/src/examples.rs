//! `cargo xtask examples`: every example compiles, and those that need nothing but patience run.

use std::fs;
use std::path::Path;

use crate::scratch::Scratch;
use crate::{Outcome, command, workspace};

/// Folders of examples that run without arguments.
const PLAIN: [&str; 2] = ["examples", "crates/libration/examples"];

/// Those of them that measure speed, with an argument that makes them short enough: nobody reads it here.
const MEASURING: [(&str, &str); 2] = [("block_machine", "1000"), ("linear_loops", "64")];

/// Examples of other crates that write a page into the file named by their first argument.
const DRAWING: [&str; 2] = ["gallery", "robot_joint"];

/// Examples of the laboratory that study something at the effort of their own configuration and
/// report into the folder named by their second argument.
const STUDYING: [&str; 1] = ["own_system"];

/// Examples of advice that follow it, with an argument that makes them short enough.
const ADVISING: [(&str, &str); 2] = [("satellite", "30"), ("stiff_spring", "")];

/// Builds all examples of the workspace, then runs them.
///
/// With the tests, which build them as well: `cargo build` and `cargo test` would each take the other's
/// for out of date.
pub(crate) fn run() -> Outcome {
    command::run(&mut command::cargo("test --workspace --no-run"))?;
    run_built()
}

/// Runs all examples, which are known to be built.
pub(crate) fn run_built() -> Outcome {
    for folder in PLAIN {
        for name in examples_in(&workspace::root().join(folder)) {
            println!("example {name}");
            let argument = MEASURING.iter().find(|(measuring, _)| *measuring == name);
            let mut example = command::program(built(&name));
            command::run(example.args(argument.map(|(_, argument)| argument)))?;
        }
    }
    let scratch = Scratch::new("examples")?;
    let folder = workspace::root().join("crates/libration-lab/examples");
    for name in STUDYING {
        println!("example {name}");
        let config = folder.join(format!("{name}.toml"));
        let report = scratch.path().join(name);
        command::run(command::program(built(name)).arg(config).arg(&report))?;
        if !report.join("report.html").exists() {
            return Err(format!("example {name} wrote no report"));
        }
    }
    for (name, argument) in ADVISING {
        println!("example {name}");
        let mut example = command::program(built(name));
        command::run(example.args(Some(argument).filter(|argument| !argument.is_empty())))?;
    }
    for name in DRAWING {
        println!("example {name}");
        let page = scratch.path().join(format!("{name}.html"));
        command::run(command::program(built(name)).arg(page))?;
    }
    Ok(())
}

fn built(example: &str) -> std::path::PathBuf {
    workspace::built(&format!("debug/examples/{example}"))
}

/// The names of the examples in `folder`, sorted: `NAME.rs` or `NAME/main.rs`.
fn examples_in(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let mut names: Vec<String> = entries
        .map(|entry| entry.path())
        .filter(|path| path.extension().is_some_and(|e| e == "rs") || path.join("main.rs").exists())
        .filter_map(|path| Some(path.file_stem()?.to_str()?.to_owned()))
        .collect();
    names.sort();
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn examples_are_files_and_folders_with_a_main() {
        let scratch = Scratch::new("finds-examples").unwrap();
        fs::write(scratch.path().join("orbit.rs"), "").unwrap();
        fs::write(scratch.path().join("notes.md"), "").unwrap();
        fs::create_dir(scratch.path().join("cart")).unwrap();
        fs::write(scratch.path().join("cart/main.rs"), "").unwrap();
        fs::create_dir(scratch.path().join("data")).unwrap();
        assert_eq!(examples_in(scratch.path()), ["cart", "orbit"]);
    }

    #[test]
    fn a_folder_that_does_not_exist_holds_no_examples() {
        assert!(examples_in(Path::new("no/such/folder")).is_empty());
    }
}
