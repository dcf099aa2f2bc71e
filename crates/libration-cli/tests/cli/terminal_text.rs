//! Text of files on a terminal, which must not change it.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use serde_json::Value;

use super::advise::libration;

/// Text that acts on a terminal, or turns the direction of writing.
const ACTING: [&str; 6] = [
    "\u{1b}]0;owned\u{7}",
    "\u{1b}[2J",
    "\u{9b}31m",
    "\u{202e}gnp",
    "\u{2066}x\u{2069}",
    "\u{7f}\u{8}",
];

/// A file with an oscillator, whose name, description and unit are this text.
fn system(text: &str) -> String {
    format!(
        "[system]\nname = \"{text}\"\ndescription = \"{text}\"\ncoordinates = [\"q\"]\nacceleration.q = \"-k*q\"\n\
         parameters = {{ k = {{ value = 9.0, unit = \"{text}\" }} }}\nunits = {{ q = \"rad\" }}\nstart = {{ q = 1.0 }}\n"
    )
}

/// The output of the program on a terminal: of both streams.
fn on_terminal(folder: &Path, words: &[&str]) -> String {
    let program = assert_cmd::cargo::cargo_bin("libration");
    let run = "import os, pty, sys; sys.exit(os.waitstatus_to_exitcode(pty.spawn(sys.argv[1:])))";
    let output = Command::new("python3")
        .args(["-I", "-c", run])
        .arg(program)
        .args(words)
        .current_dir(folder)
        // Bars move the cursor.
        .env("TERM", "dumb")
        .stdin(Stdio::null())
        .output()
        .unwrap();
    String::from_utf8(output.stdout).unwrap()
}

/// Checks that nothing of a file acts on the terminal.
fn check(text: &str, what: &str) {
    for acting in ACTING {
        for c in acting.chars().filter(|c| c.is_control() && *c != '\u{1b}' || *c >= '\u{2000}') {
            assert!(!text.contains(c), "{what}: {c:?} in {text:?}");
        }
    }
    for (at, _) in text.match_indices('\u{1b}') {
        let rest = text[at..].trim_start_matches('\u{1b}').trim_start_matches('[');
        let end = rest.trim_start_matches(|c: char| c.is_ascii_digit() || c == ';');
        assert!(
            end.starts_with('m'),
            "{what}: {:?}",
            &text[at..].chars().take(20).collect::<String>()
        );
    }
    // A line of the program's own has its styles before it, and the text within.
    let unstyled = |line: &str| {
        let parts = line.split('\u{1b}');
        parts.map(|part| part.split_once('m').map_or(part, |(_, rest)| rest)).collect::<String>()
    };
    for line in text.lines().filter(|line| line.contains("forged")) {
        let is_styled = line.starts_with('\u{1b}');
        let plain = if is_styled { unstyled(line) } else { line.to_owned() };
        assert!(!plain.starts_with("error: forged"), "{what}: {line:?}");
    }
}

#[test]
fn text_of_files_does_not_act_on_a_terminal() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    // As TOML and JSON write them.
    let acting = ACTING.concat() + "\r\nerror: forged";
    let escaped: String = acting.encode_utf16().map(|unit| format!("\\u{unit:04x}")).collect();
    write("system.toml", &system(&format!("a{escaped}")));
    let units = system("x").replace("\"rad\"", &format!("\"{escaped}\""));
    write("units.toml", &units);
    write("key.toml", &format!("\"c{escaped}\" = 1\n{}", system("x")));
    // A text with others is none.
    let header = "\u{9b}31m\u{202e}gnp\u{2066}";
    write("log.csv", &format!("\"d{header}\",x\n0,1\n0.01,2\n0.02,3\n0.03,1\n"));
    write("bare.toml", &system(&ACTING.concat()));
    let record = |id: &str| {
        format!(
            "{{\"schema\": \"{}\", \"config\": {{\"x\": \"{escaped}\"}}, \"studies\": [], \"machine\": {{\"{id}\": 1}}}}",
            "libration.results/1"
        )
    };
    write("old.json", &record(&escaped));
    write("new.json", &record("other"));
    fs::create_dir(folder.path().join("set")).unwrap();
    write("set/manifest.jsonl", &format!("{{\"version\": \"{escaped}\"}}\n"));
    write(
        "servos.json",
        &format!(
            "{{\"mass\": [[1.0]], \"kp\": [1.0], \"kv\": [1.0], \"joints\": [\"{escaped}\"]}}"
        ),
    );
    for words in [
        &["list", "system.toml"][..],
        &["list", "system.toml", "--json"],
        &["analyze", "--system", "system.toml", "--integrator", "rk4", "--dt", "0.01"],
        &["analyze", "--system", "system.toml", "--integrator", "rk4", "--dt", "0.01", "--json"],
        &["analyze", "--system", "key.toml", "--integrator", "rk4", "--dt", "0.01"],
        &["analyze", "--system", "bare.toml", "--integrator", "rk4", "--dt", "0.01"],
        &["list", "units.toml"],
        &["clock", "log.csv"],
        &["clock", "log.csv", "--json"],
        &["clock", "log.csv", "--topic", "nosuch"],
        &["compare", "old.json", "new.json"],
        &["compare", "old.json", "new.json", "--json"],
        &["verify", "set"],
        &["join", "set", "--out", "joined"],
        &["gains", "--matrices", "servos.json", "--dt", "0.01"],
        &[
            "probe",
            "--command",
            "printf '\\033]0;owned\\007\\r\\nerror: forged\\n'",
            "--state",
            "0",
            "--dt",
            "1",
        ],
        &[
            "probe",
            "--command",
            "sh -c \"printf '\\033]0;owned\\007' >&2\"",
            "--state",
            "0",
            "--dt",
            "1",
        ],
    ] {
        let text = on_terminal(folder.path(), words);
        // Other commands may leave the text out, or have marks in its place.
        let is_shown = words[0] == "list" || words.contains(&"system.toml");
        assert!(!is_shown || text.contains("\\u"), "{words:?}: {text:?}");
        assert!(!text.trim().is_empty(), "{words:?}");
        check(&text, &words.join(" "));
    }
}

#[test]
fn json_keeps_the_text_of_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("system.toml");
    let name = "a\u{9b}\u{202e}b\u{7f}";
    fs::write(&file, system("a\\u009b\\u202eb\\u007f")).unwrap();
    let output = libration(&["list", file.to_str().unwrap(), "--json"]).success();
    let value: Value = serde_json::from_slice(&output.get_output().stdout).unwrap();
    assert_eq!(value["name"], name);
}

#[test]
fn names_of_any_length_are_shown() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("system.toml");
    for length in [65_535, 65_536, 100_000] {
        let name = "x".repeat(length);
        let text = format!(
            "[system]\nname = \"long\"\ncoordinates = [\"{name}\"]\nacceleration.{name} = \"-1.0\"\n\
             parameters = {{ k{name} = {{ value = 9.0, unit = \"{name}\" }} }}\nunits = {{ {name} = \"{name}\" }}\n\
             start = {{ {name} = 1.0 }}\n"
        );
        fs::write(&file, text).unwrap();
        let file = file.to_str().unwrap();
        for words in [
            &["list", file][..],
            &["analyze", "--system", file, "--integrator", "rk4", "--dt", "0.01"],
        ] {
            let output = libration(words).get_output().clone();
            let errors = String::from_utf8_lossy(&output.stderr).into_owned();
            assert_eq!(output.status.code(), Some(0), "{length}: {errors:.300}");
        }
    }
}
