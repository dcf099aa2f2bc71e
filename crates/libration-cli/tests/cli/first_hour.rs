//! The commands of `docs/first-hour.md`.

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

#[test]
fn each_block_of_the_first_hour_runs_and_prints_what_the_page_says() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let text = fs::read_to_string(root.join("docs/first-hour.md")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let program = PathBuf::from(env!("CARGO_BIN_EXE_libration"));
    let path = env::var("PATH").unwrap_or_default();
    let path = format!("{}:{path}", program.parent().unwrap().display());
    let mut printed = String::new();
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
                printed = String::from_utf8_lossy(&shell.stdout).into_owned();
                let errors = String::from_utf8_lossy(&shell.stderr);
                assert!(shell.status.success(), "{text}\n{printed}\n{errors}");
                commands += text.lines().filter(|line| line.starts_with("libration ")).count();
            }
            "text" => {
                for line in text.lines() {
                    assert!(printed.contains(line), "the page promises `{line}`:\n{printed}");
                }
            }
            // Installation, which needs a network.
            _ => assert!(text.contains("install"), "{text}"),
        }
    }
    assert!(commands > 12, "{commands}");
}
