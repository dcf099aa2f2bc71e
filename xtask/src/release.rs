//! `cargo xtask release`: the files of a release of the Python package, checked.

use std::fs;
use std::path::{Path, PathBuf};

use crate::{Outcome, command, python, workspace};

/// Programs that build and check wheels: Zig links against an old glibc, whatever that of this machine is.
const TOOLS: [&str; 3] = ["maturin==1.16.0", "ziglang==0.17.1", "auditwheel==6.8.2"];

/// The oldest glibc on which the wheel runs: that of `manylinux2014`.
const COMPATIBILITY: &str = "manylinux_2_17";

/// Interpreters on which the wheel is tried, of which those that are installed count.
const INTERPRETERS: [&str; 5] =
    ["python3.10", "python3.11", "python3.12", "python3.13", "python3.14"];

/// The largest wheel, in bytes: the program, the studies and kernels for three instruction sets.
const LARGEST: u64 = 10_000_000;

/// What an installed wheel must do.
const TRIAL: &str = "
import libration
envs = libration.Environments('Pendulum', 4, omega2=libration.Uniform(10, 20))
envs.reset(seed=0)
path = libration.simulate('oscillator', integrator='rk4', dt=0.01, steps=100)
advice = libration.advise(libration.System('oscillator', omega2=10.0), libration.PD(10.0, 2.0), latency=0.05)
assert advice.holds and len(path['t']) == 101 and envs.rollout(libration.policies.Random(-1.0, 1.0), 8).rewards.shape == (8, 4)
";

/// Builds a source distribution and a wheel for Linux into `target/release-files`, checks both, and tries the wheel.
pub(crate) fn run() -> Outcome {
    if !cfg!(target_os = "linux") {
        return Err(
            "the wheel of this task is one for Linux; docs/release.md has the commands for others"
                .to_owned(),
        );
    }
    let folder = workspace::target().join("release-files");
    // It may not be there.
    let _ = fs::remove_dir_all(&folder);
    let tools = environment("release-tools", python::interpreter()?.as_path(), &TOOLS)?;
    let maturin = |arguments: &[&str]| {
        let mut build = command::program(&tools);
        build.args(["-m", "maturin"]).args(arguments).arg("--out").arg(&folder);
        // Where it finds Zig.
        build.env("PATH", path_with(&tools));
        build
    };
    command::run(&mut maturin(&["sdist"]))?;
    let target = format!("{}-unknown-linux-gnu", std::env::consts::ARCH);
    let build = ["build", "--profile", "wheel", "--zig", "--compatibility", COMPATIBILITY];
    command::run(maturin(&build).args(["--target", &target]))?;
    let source = file_in(&folder, ".tar.gz")?;
    let wheel = file_in(&folder, ".whl")?;
    let size = |path: &Path| fs::metadata(path).map_or(0, |file| file.len());
    println!(
        "{}: {} bytes\n{}: {} bytes",
        source.display(),
        size(&source),
        wheel.display(),
        size(&wheel)
    );
    if size(&wheel) > LARGEST {
        return Err(format!("the wheel has {} bytes, of at most {LARGEST}", size(&wheel)));
    }
    command::run(command::program(&tools).args(["-m", "auditwheel", "show"]).arg(&wheel))?;
    let mut tried = Vec::new();
    for interpreter in INTERPRETERS {
        if command::output(command::program(interpreter).arg("--version")).is_err() {
            continue;
        }
        let name = format!("release-trial-{interpreter}");
        let python = environment(&name, Path::new(interpreter), &["numpy"])?;
        let mut install = pip(&python);
        command::run(install.args(["--no-deps", "--force-reinstall"]).arg(&wheel))?;
        command::run(command::program(&python).current_dir(&folder).args(["-c", TRIAL]))?;
        tried.push(interpreter);
    }
    if tried.is_empty() {
        return Err(format!("no interpreter to try the wheel on: {}", INTERPRETERS.join(", ")));
    }
    println!("tried on {}", tried.join(", "));
    Ok(())
}

/// The interpreter of a virtual environment in `target` with these packages.
fn environment(name: &str, base: &Path, packages: &[&str]) -> Result<PathBuf, String> {
    let folder = workspace::target().join(name);
    let python = folder.join("bin/python");
    if !python.exists() {
        command::run(command::program(base).args(["-m", "venv", "--clear"]).arg(&folder))?;
    }
    command::run(pip(&python).args(packages))?;
    Ok(python)
}

fn pip(python: &Path) -> std::process::Command {
    let mut pip = command::program(python);
    pip.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"]);
    pip
}

/// The search path with the programs of an environment first.
fn path_with(python: &Path) -> std::ffi::OsString {
    let own = python.parent().map(Path::to_path_buf).into_iter();
    let path = std::env::var_os("PATH").unwrap_or_default();
    let all = own.chain(std::env::split_paths(&path));
    std::env::join_paths(all).unwrap_or(path.clone())
}

/// The only file in a folder whose name ends so.
fn file_in(folder: &Path, end: &str) -> Result<PathBuf, String> {
    let files = fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let mut found: Vec<PathBuf> =
        files.filter(|path| path.to_string_lossy().ends_with(end)).collect();
    match (found.pop(), found.len()) {
        (Some(path), 0) => Ok(path),
        (_, others) => {
            Err(format!("{} files *{end} in {}; expected one", others, folder.display()))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scratch::Scratch;

    #[test]
    fn a_release_has_one_file_of_each_kind() {
        let scratch = Scratch::new("release").unwrap();
        assert!(file_in(scratch.path(), ".whl").is_err());
        for name in ["a.whl", "a.tar.gz"] {
            fs::write(scratch.path().join(name), "").unwrap();
        }
        assert_eq!(file_in(scratch.path(), ".whl"), Ok(scratch.path().join("a.whl")));
        fs::write(scratch.path().join("b.whl"), "").unwrap();
        assert!(file_in(scratch.path(), ".whl").is_err());
    }
}
