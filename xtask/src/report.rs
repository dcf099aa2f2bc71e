//! `cargo xtask report`: the program as a user gets it, run once from end to end.

use std::fs;
use std::path::{Path, PathBuf};

use crate::scratch::Scratch;
use crate::{Outcome, command, workspace};

/// Returns the folder of the report.
pub(crate) fn folder() -> PathBuf {
    workspace::target().join("report")
}

/// Runs a quick `lab` with all studies, which is to be quiet, and looks at what it wrote into [`folder`].
///
/// With the binary that the tests have built: a release build would take as long as all of them, and
/// differs in nothing but its speed.
pub(crate) fn run() -> Outcome {
    command::run(&mut command::cargo("test --workspace --no-run"))?;
    run_built()
}

/// The same with a binary that is known to be there.
pub(crate) fn run_built() -> Outcome {
    let (scratch, out) = (Scratch::new("report")?, folder());
    // It may not be there.
    let _ = fs::remove_dir_all(&out);
    command::silent(
        command::program(workspace::built("debug/libration"))
            .args(["lab", "--all", "--effort", "quick", "--quiet", "--out"])
            .arg(&out)
            .current_dir(scratch.path()),
    )?;
    match missing_in(&out).as_slice() {
        [] => Ok(()),
        missing => {
            Err(format!("`libration lab` exited with 0, but did not write {}", missing.join(", ")))
        }
    }
}

/// The parts of a report that `folder` lacks, or holds empty.
fn missing_in(folder: &Path) -> Vec<&'static str> {
    let mut missing = Vec::new();
    for file in ["report.html", "results.json"] {
        if is_empty(&folder.join(file)) {
            missing.push(file);
        }
    }
    for (pattern, subfolder, extension) in
        [("figures/*.svg", "figures", "svg"), ("data/*.parquet", "data", "parquet")]
    {
        let entries = fs::read_dir(folder.join(subfolder)).into_iter().flatten().flatten();
        let files: Vec<_> = entries
            .map(|entry| entry.path())
            .filter(|path| path.extension().is_some_and(|e| e == extension))
            .collect();
        if files.is_empty() || files.iter().any(|file| is_empty(file)) {
            missing.push(pattern);
        }
    }
    missing
}

fn is_empty(file: &Path) -> bool {
    !fs::metadata(file).is_ok_and(|data| data.len() > 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_report_needs_its_page_results_figures_and_data() {
        let scratch = Scratch::new("missing").unwrap();
        let out = scratch.path();
        let all = ["report.html", "results.json", "figures/*.svg", "data/*.parquet"];
        assert_eq!(missing_in(out), all);

        for folder in ["figures", "data"] {
            fs::create_dir(out.join(folder)).unwrap();
        }
        for file in ["report.html", "results.json", "figures/a.svg", "data/a.parquet"] {
            fs::write(out.join(file), "x").unwrap();
        }
        assert!(missing_in(out).is_empty());

        fs::write(out.join("results.json"), "").unwrap();
        fs::write(out.join("figures/b.svg"), "").unwrap();
        assert_eq!(missing_in(out), ["results.json", "figures/*.svg"]);
    }
}
