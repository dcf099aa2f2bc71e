//! The commands of `docs/first-hour.md` and of the pages of cases.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

/// A block of the document: the word behind its fence, and its text.
fn blocks(text: &str) -> Vec<(String, String)> {
    let mut parts = text.split("```");
    let mut all = Vec::new();
    while let (Some(_), Some(block)) = (parts.next(), parts.next()) {
        let (kind, text) = block.split_once('\n').unwrap();
        all.push((kind.to_owned(), text.to_owned()));
    }
    all
}

/// Runs the `sh` blocks of a page in an empty folder, in their order, and compares their output with the `text` blocks after them.
/// Returns the number of commands of the program.
fn run_page(page: &str) -> usize {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let text = fs::read_to_string(root.join("docs").join(page)).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let program = PathBuf::from(env!("CARGO_BIN_EXE_libration"));
    let path = env::var("PATH").unwrap_or_default();
    let path = format!("{}:{path}", program.parent().unwrap().display());
    let mut printed: Option<String> = None;
    let mut commands = 0;
    for (kind, text) in blocks(&text) {
        match kind.as_str() {
            "sh" => {
                let shell = Command::new("sh")
                    .args(["-e", "-c", &text])
                    .current_dir(&folder)
                    .env("PATH", &path)
                    .output()
                    .unwrap();
                let output = String::from_utf8_lossy(&shell.stdout).into_owned();
                let errors = String::from_utf8_lossy(&shell.stderr);
                assert!(shell.status.success(), "{text}\n{output}\n{errors}");
                commands += text.lines().filter(|line| line.starts_with("libration ")).count();
                printed = Some(output);
            }
            "text" => {
                if let Some(printed) = &printed {
                    for line in text.lines() {
                        assert!(printed.contains(line), "the page promises `{line}`:\n{printed}");
                    }
                }
            }
            // A test of the Python package runs these, and compares the text after them.
            "python" => printed = None,
            // Installation, which needs a network.
            _ => assert!(text.contains("install"), "{text}"),
        }
    }
    commands
}

#[test]
fn each_block_of_the_first_hour_runs_and_prints_what_the_page_says() {
    let commands = run_page("first-hour.md");
    assert!(commands > 12, "{commands}");
}

#[test]
fn the_case_of_a_shaking_joint_runs_and_prints_what_the_page_says() {
    assert_eq!(run_page("case-shaking-joint.md"), 8);
}

#[test]
fn the_case_of_an_error_budget_runs_and_prints_what_the_page_says() {
    assert_eq!(run_page("case-error-budget.md"), 4);
}

#[test]
fn the_case_of_rates_of_a_policy_runs_and_prints_what_the_page_says() {
    assert_eq!(run_page("case-policy-rates.md"), 3);
}
