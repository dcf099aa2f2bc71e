//! Whole outputs of commands, each through each of its doors, as files: a change of a text, of a number or of an exit code shows in the files
//! that it changes.
//!
//! `LIBRATION_RENEW_SNAPSHOTS=1` writes them anew; the change is to be read before it is kept.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::{env, fs, thread};

const FOLDER: &str = "tests/snapshots";

/// The exit code and all outputs of a command.
fn snapshot(words: &str) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_libration"))
        .args(words.split_whitespace())
        .env_remove("COLUMNS")
        .env("NO_COLOR", "1")
        .output()
        .expect("the program runs");
    let code = output.status.code().expect("no signal");
    let mut text = format!("$ {}\nexit code {code}\n", format!("libration {words}").trim_end());
    for (name, bytes) in [("output", output.stdout), ("errors", output.stderr)] {
        if !bytes.is_empty() {
            let _ = writeln!(text, "--- {name}");
            // Speeds are those of the machine.
            let all = String::from_utf8_lossy(&bytes);
            let kept = all.lines().filter(|line| !line.contains("_a_second"));
            kept.for_each(|line| text += &format!("{line}\n"));
        }
    }
    text
}

/// The first line in which two texts differ.
fn difference(kept: &str, found: &str) -> String {
    let both = kept.lines().zip(found.lines()).enumerate().find(|(_, (a, b))| a != b);
    match both {
        Some((i, (a, b))) => format!("line {}:\n  kept  {a}\n  found {b}", i + 1),
        None => format!("{} lines kept, {} found", kept.lines().count(), found.lines().count()),
    }
}

#[test]
fn outputs_of_all_commands_are_those_that_are_kept() {
    let list = fs::read_to_string(Path::new(FOLDER).join("commands.txt")).unwrap();
    let commands: Vec<(&str, &str)> = list
        .lines()
        .filter(|line| !line.starts_with('#'))
        .map(|line| line.split_once('|').expect("a name and a command"))
        .map(|(name, words)| (name.trim(), words.trim()))
        .collect();
    let renews = env::var_os("LIBRATION_RENEW_SNAPSHOTS").is_some();
    let next = AtomicUsize::new(0);
    let differences = || {
        let mut found = Vec::new();
        while let Some((name, words)) = commands.get(next.fetch_add(1, Ordering::Relaxed)) {
            let path: PathBuf = Path::new(FOLDER).join(format!("{name}.txt"));
            let text = snapshot(words);
            if renews {
                fs::write(&path, text).unwrap();
            } else {
                let kept = fs::read_to_string(&path).unwrap_or_default();
                if kept != text {
                    found.push(format!("{name}: {}", difference(&kept, &text)));
                }
            }
        }
        found
    };
    let threads = thread::available_parallelism().map_or(1, usize::from);
    let mut all: Vec<String> = thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(differences)).collect();
        workers.into_iter().flat_map(|worker| worker.join().unwrap()).collect()
    });
    all.sort();
    assert!(all.is_empty(), "{} outputs differ:\n{}", all.len(), all.join("\n"));
    let files =
        fs::read_dir(FOLDER).unwrap().filter(|entry| entry.as_ref().unwrap().path().is_file());
    assert_eq!(files.count(), commands.len() + 1, "a file that no command writes");
}
