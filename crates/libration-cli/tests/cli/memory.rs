//! Limits of the memory that the program may have (`ulimit -v`).

use std::process::{Command, Output};

use crate::rollout::settings;

/// Runs the program with so many MB of addresses.
fn limited(folder: &std::path::Path, megabytes: u64, words: &str) -> Output {
    let program = assert_cmd::cargo::cargo_bin("libration");
    let script = format!("ulimit -v {}; exec {} {words}", megabytes * 1000, program.display());
    Command::new("bash").args(["-c", &script]).current_dir(folder).output().unwrap()
}

/// The exit code of a run under a limit: that of success, or 1 with a message. Whatever else it is, panics.
fn code(folder: &std::path::Path, megabytes: u64, words: &str) -> i32 {
    let output = limited(folder, megabytes, words);
    let said = String::from_utf8_lossy(&output.stderr);
    let at = || format!("{megabytes} MB: {words}: {:?}\n{said}", output.status);
    let code = output.status.code().unwrap_or_else(|| panic!("{}", at()));
    assert!(code == 0 || code == 1, "{}", at());
    assert_eq!(code == 0, said.is_empty(), "{}", at());
    assert!(!said.contains("panicked") && !said.contains("this is a bug"), "{}", at());
    code
}

#[test]
fn a_limit_of_memory_ends_a_run_with_a_message_and_never_with_an_abort() {
    // Few environments: each episode is a file for Minari.
    let dir = settings("num_envs = 100\nsteps = 3000\n[chunk]\nsteps = 1000\n");
    let folder = dir.path();
    // What it takes to begin: the program, its stacks, and the memory that the system sets apart for each thread.
    let begins = |megabytes: &u64| limited(folder, *megabytes, "list").status.code() == Some(0);
    let least = (1..).map(|i| 20 * i).find(begins).unwrap();
    let rollout = |format: &str, i: u64| {
        format!(
            "--quiet rollout --config set.toml --threads 2 --format {format} --out {format}-{i}"
        )
    };
    let simulate = "--quiet simulate --system oscillator --integrator leapfrog --dt 0.01";
    // Where little is left, the allocator asks the system for each piece, and a run takes a second.
    for more in [1, 12, 50, 200] {
        let megabytes = least + more;
        for format in ["npy", "parquet", "minari"] {
            code(folder, megabytes, &rollout(format, more));
        }
        for (name, flags) in [
            ("x.parquet", "--steps 3e5"),
            ("x.npy", "--steps 3e5"),
            ("y.npy", "--steps 2 --save-every 2 --num-trajectories 2e4 --threads 2"),
            (
                "z.npy",
                "--steps 2 --save-every 2 --num-trajectories 1e4 --threads 2 --feedback 10,2 --latency 0.02",
            ),
        ] {
            code(folder, megabytes, &format!("{simulate} {flags} --output {name}"));
        }
    }
    // Enough is enough.
    assert_eq!(code(folder, 8000, &rollout("parquet", 99)), 0);
    assert_eq!(code(folder, 8000, &format!("{simulate} --steps 3e5 --output x.parquet")), 0);
}

#[test]
fn what_does_not_fit_under_a_limit_says_how_much_is_needed_and_what_lowers_it() {
    let dir = settings("num_envs = 4096\n");
    let said = |words: &str| {
        let output = limited(dir.path(), 700, words);
        assert_eq!(output.status.code(), Some(1), "{output:?}");
        String::from_utf8(output.stderr).unwrap()
    };
    // 2·10⁷ rows of a step, a time and three numbers of 8 bytes, and the memory that it takes to encode a million of them.
    let table = said(
        "simulate --system oscillator --integrator leapfrog --dt 0.01 --steps 2e7 --output x.parquet",
    );
    assert!(table.contains("0.892 GB of memory are needed, of which 0."), "{table}");
    assert!(table.contains("(--num-trajectories, --save-every, --dtype)"), "{table}");
    let chunks = said("rollout --config set.toml --out data");
    assert!(chunks.contains("GB of memory are needed, of which 0."), "{chunks}");
    assert!(chunks.contains("(chunk.steps is 1024, chunk.num_envs 4096)"), "{chunks}");
    assert!(!dir.path().join("data").exists() && !dir.path().join("x.parquet").exists());
}
