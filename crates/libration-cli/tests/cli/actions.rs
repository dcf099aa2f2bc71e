//! Commands that reports recommend.

use std::fs;
use std::path::{Path, PathBuf};

use super::advise::libration;

/// The Rust files in a folder and its folders.
fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

/// The commands between backticks in the strings of a source, with values in place of `{}`.
fn commands(source: &str) -> Vec<String> {
    let lines = source.lines().filter(|line| !line.trim_start().starts_with("//"));
    let joined = lines.map(|line| line.trim().trim_end_matches('\\')).collect::<Vec<_>>().join(" ");
    let pieces = joined.split('`').filter(|piece| piece.starts_with("libration "));
    let filled = pieces.map(|piece| {
        let piece = piece.replace("--integrator {}", "--integrator rk4");
        piece
            .replace("--system FILE", "--system mine.toml")
            .replace("{tolerance}", "0.001")
            .replace("{value:e}", "1e-4")
    });
    filled.collect()
}

/// Whether the program knows the words of a command: with `--help` it checks options and values before, and then does nothing.
#[track_caller]
pub(super) fn assert_parses(command: &str) {
    let words: Vec<&str> =
        command.split_whitespace().skip(1).take_while(|word| *word != ">").collect();
    libration(&[&words[..], &["--help"]].concat()).success();
}

#[test]
fn every_command_in_the_chapters_of_studies_parses() {
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut files = Vec::new();
    for name in ["libration-study-motion", "libration-study-loops", "libration-study-batch"] {
        sources(&crates.join(name).join("src"), &mut files);
    }
    let texts: Vec<String> = files.iter().map(|file| fs::read_to_string(file).unwrap()).collect();
    let all: Vec<String> = texts.iter().flat_map(|text| commands(text)).collect();
    assert!(all.len() >= 25, "{all:#?}");
    for command in all {
        assert!(!command.contains('{'), "{command}");
        assert_parses(&command);
    }
}

#[test]
fn an_option_that_does_not_exist_does_not_parse() {
    for words in [&["analyze", "--wrong", "--help"][..], &["advise", "--horizon", "x", "--help"]] {
        libration(words).code(2);
    }
}
