//! A file that is replaced keeps what it is: permissions, owner and links.

use std::fs;
use std::io::{Read, Write};
use std::os::unix::fs::{MetadataExt, PermissionsExt, chown, symlink};
use std::path::Path;
use std::process::{Command as Process, Stdio};

use assert_cmd::Command;

const SIMULATE: [&str; 11] = [
    "simulate",
    "--system",
    "oscillator",
    "--integrator",
    "rk4",
    "--dt",
    "0.01",
    "--steps",
    "10",
    "--save-every",
    "10",
];

fn simulate(output: &Path) {
    let mut command = Command::cargo_bin("libration").unwrap();
    command.args(SIMULATE).arg("--output").arg(output).assert().success();
}

/// Whether a file holds the rows of [`SIMULATE`], and no more.
fn is_replaced(path: &Path) -> bool {
    let text = fs::read_to_string(path).unwrap();
    text.starts_with("step,t,") && text.lines().count() == 3
}

/// Asserts that a folder holds these files and no other.
fn assert_holds(folder: &Path, names: &[&str]) {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name());
    let mut found: Vec<String> = entries.map(|name| name.into_string().unwrap()).collect();
    found.sort();
    assert_eq!(found, names);
}

#[test]
fn a_replaced_file_keeps_its_permissions_and_its_owner() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.csv");
    let page = folder.path().join("page.html");
    for path in [&path, &page] {
        fs::write(path, "old").unwrap();
        // Only the superuser gives files away.
        let _ = chown(path, Some(12_345), Some(12_345));
    }
    for mode in [0o600, 0o640, 0o664, 0o755] {
        for path in [&path, &page] {
            fs::set_permissions(path, fs::Permissions::from_mode(mode)).unwrap();
        }
        let before = fs::metadata(&path).unwrap();
        simulate(&path);
        let mut advise = Command::cargo_bin("libration").unwrap();
        let words = ["-q", "advise", "--system", "oscillator", "--horizon", "1", "--page"];
        advise.args(words).arg(&page).assert().success();
        assert!(is_replaced(&path));
        assert_ne!(fs::read(&page).unwrap(), b"old");
        for path in [&path, &page] {
            let after = fs::metadata(path).unwrap();
            assert_eq!(after.mode() & 0o7777, mode, "{path:?}");
            assert_eq!((after.uid(), after.gid()), (before.uid(), before.gid()), "{path:?}");
        }
        // A new name is a new file: it was never half written.
        assert_ne!(fs::metadata(&path).unwrap().ino(), before.ino());
    }
}

#[test]
fn a_hard_linked_file_has_the_result_under_all_its_names() {
    let folder = tempfile::tempdir().unwrap();
    let [path, other] = ["x.csv", "y.csv"].map(|name| folder.path().join(name));
    // Longer than the result: nothing of it stays.
    fs::write(&path, "old\n".repeat(1000)).unwrap();
    fs::hard_link(&path, &other).unwrap();
    fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
    simulate(&path);
    assert!(is_replaced(&path) && is_replaced(&other));
    let [path, other] = [&path, &other].map(|path| fs::metadata(path).unwrap());
    assert_eq!(path.ino(), other.ino());
    assert_eq!(path.mode() & 0o7777, 0o640);
    assert_holds(folder.path(), &["x.csv", "y.csv"]);
}

#[test]
fn a_symbolic_link_stays_one_and_what_it_leads_to_is_written_even_if_it_is_new() {
    let folder = tempfile::tempdir().unwrap();
    let inner = folder.path().join("inner");
    fs::create_dir(&inner).unwrap();
    let [path, link] = ["x.csv", "link.csv"].map(|name| folder.path().join(name));
    symlink("link.csv", &path).unwrap();
    symlink("inner/y.csv", &link).unwrap();
    for _ in 0..2 {
        simulate(&path);
        assert!([&path, &link].into_iter().all(|path| path.is_symlink()));
        let written = inner.join("y.csv");
        assert!(!written.is_symlink() && is_replaced(&written));
        fs::write(written, "old").unwrap();
    }
    assert_holds(folder.path(), &["inner", "link.csv", "x.csv"]);
    assert_holds(&inner, &["y.csv"]);
    // A link that leads to itself leads nowhere.
    symlink("loop.csv", folder.path().join("loop.csv")).unwrap();
    let mut command = Command::cargo_bin("libration").unwrap();
    command.args(SIMULATE).arg("--output").arg(folder.path().join("loop.csv")).assert().code(2);
}

#[cfg(target_os = "linux")]
#[test]
fn a_pipe_that_has_a_name_is_written_to() {
    let mut child = Process::new(assert_cmd::cargo::cargo_bin("libration"))
        .args(SIMULATE)
        .args(["--output", "/dev/stdout", "--format", "csv"])
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut text = String::new();
    child.stdout.take().unwrap().read_to_string(&mut text).unwrap();
    assert!(child.wait().unwrap().success());
    assert!(text.starts_with("step,t,"), "{text}");
}

#[test]
fn standard_output_that_is_a_file_keeps_what_others_write_to_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("app.txt");
    let mut shared = fs::File::create(&path).unwrap();
    for name in ["/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"] {
        shared.write_all(b"header\n").unwrap();
        let mut command = Process::new(assert_cmd::cargo::cargo_bin("libration"));
        command.args(SIMULATE).args(["--format", "csv", "--output", name]);
        assert!(command.stdout(shared.try_clone().unwrap()).status().unwrap().success());
        shared.write_all(b"footer\n").unwrap();
    }
    let text = fs::read_to_string(&path).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines.len(), 3 * 5, "{text}");
    for part in lines.chunks(5) {
        assert!(part[0] == "header" && part[1].starts_with("step,t,") && part[4] == "footer");
    }
    assert_holds(folder.path(), &["app.txt"]);
}
