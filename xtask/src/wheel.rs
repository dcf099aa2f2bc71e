//! The Python package: its wheel, and its tests.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::suites::{self, Suite};
use crate::{Outcome, command, python, workspace};

/// The release that the package is tested with besides the newest, which others pin.
const OLDER_GYMNASIUM: &str = "gymnasium==1.2.2";

/// The processes over which the tests of the package are divided: an import of NumPy and JAX costs seconds in each of them.
const PROCESSES: usize = 4;

/// Files of tests that take longest, which are divided first.
const LONG: [&str; 12] = [
    "test_documentation.py",
    "test_probe_gymnasium_wrappers.py",
    "test_cluster.py",
    "test_stubs.py",
    "test_probe_fmu.py",
    "test_hosts_fmu.py",
    "test_probe_mujoco.py",
    "test_linear.py",
    "test_gains_mujoco.py",
    "test_probe.py",
    "test_examples.py",
    "test_properties.py",
];

/// Builds and installs the wheel, then runs the tests of the package; with `arguments`, pytest with them, also with the older Gymnasium.
pub(crate) fn test(arguments: &[String]) -> Outcome {
    let python = python::interpreter()?;
    if arguments.is_empty() {
        return suites::run(vec![suite(&python)?]);
    }
    install()?;
    for path in [None, Some(older_gymnasium(&python)?)] {
        command::run(pytest(&python, path.as_deref()).args(arguments))?;
    }
    Ok(())
}

/// Builds and installs the wheel. All tests of the package follow with the newest Gymnasium, and those that depend on it with the older one.
pub(crate) fn suite(python: &Path) -> Result<Suite, String> {
    let folder = workspace::root().join("python/tests");
    let this = std::env::current_exe().map_err(|error| error.to_string())?;
    let mut wheel = command::program(this);
    wheel.arg("wheel");
    let mut suite = Suite::new("the wheel", wheel);
    let mut add = |name: String, older: Option<&Path>, files: &[PathBuf]| {
        let mut tests = pytest(python, older);
        tests.args(files).arg("--durations=10");
        if older.is_some() {
            tests.args(["-m", "not any_gymnasium"]);
        }
        suite.then.push(Suite::new(name, tests));
    };
    for (i, files) in divided(files_in(&folder)?).iter().enumerate() {
        add(format!("the Python package, {} of {PROCESSES}", i + 1), None, files);
    }
    let older = older_gymnasium(python)?;
    add(format!("the Python package, {OLDER_GYMNASIUM}"), Some(&older), &of_gymnasium(&folder)?);
    Ok(suite)
}

/// pytest, from within the folder of the tests: the package that is tested is the one that was installed.
fn pytest(python: &Path, path: Option<&Path>) -> Command {
    let mut tests = command::program(python);
    tests.args(["-m", "pytest", "-p", "no:cacheprovider"]);
    tests.current_dir(workspace::root().join("python/tests"));
    if let Some(path) = path {
        tests.env("PYTHONPATH", path);
    }
    tests
}

/// The files of tests, sorted.
fn files_in(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let unread = |error| format!("{} cannot be read: {error}", folder.display());
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).map_err(unread)? {
        let path = entry.map_err(unread)?.path();
        if name(&path).starts_with("test_") && path.extension().is_some_and(|e| e == "py") {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}

/// The files that each process runs.
fn divided(mut files: Vec<PathBuf>) -> [Vec<PathBuf>; PROCESSES] {
    files
        .sort_by_key(|file| LONG.iter().position(|long| *long == name(file)).unwrap_or(LONG.len()));
    let mut processes = [const { Vec::new() }; PROCESSES];
    for (i, file) in files.into_iter().enumerate() {
        // There and back: who has the longest of one turn has the shortest of the next.
        let (turn, place) = (i / PROCESSES, i % PROCESSES);
        processes[if turn % 2 == 0 { place } else { PROCESSES - 1 - place }].push(file);
    }
    processes
}

fn name(file: &Path) -> &str {
    file.file_name().and_then(|name| name.to_str()).unwrap_or_default()
}

/// The files of tests that import Gymnasium: the others say the same with any.
fn of_gymnasium(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let imports = |text: &str| {
        text.lines()
            .any(|line| ["import gymnasium", "from gymnasium"].iter().any(|i| line.starts_with(i)))
    };
    let mut files = Vec::new();
    for path in files_in(folder)? {
        let text = fs::read_to_string(&path)
            .map_err(|error| format!("{} cannot be read: {error}", path.display()))?;
        if imports(&text) {
            files.push(path);
        }
    }
    if files.is_empty() { Err("no test imports Gymnasium".to_owned()) } else { Ok(files) }
}

/// Builds the wheel of what the tests of the workspace have compiled, and installs it.
pub(crate) fn install() -> Outcome {
    let python = python::interpreter()?;
    let wheels = workspace::target().join("wheels");
    // It may not be there.
    let _ = fs::remove_dir_all(&wheels);
    let mut build = command::program(&python);
    build.args(["-m", "maturin", "build", "--quiet", "--profile", "dev"]);
    build.args(["--compatibility", "linux", "--interpreter"]);
    command::run(build.arg(&python).arg("--out").arg(&wheels))?;
    let files = fs::read_dir(&wheels).into_iter().flatten().flatten().map(|entry| entry.path());
    let wheel = files.last().ok_or("maturin has built no wheel")?;
    let mut install = command::program(&python);
    install.args(["-m", "pip", "install", "--quiet", "--no-deps", "--force-reinstall"]);
    command::run(install.arg("--disable-pip-version-check").arg(wheel))
}

/// A folder with the older Gymnasium and nothing else.
fn older_gymnasium(python: &Path) -> Result<PathBuf, String> {
    let folder = workspace::target().join(OLDER_GYMNASIUM);
    if !folder.join("gymnasium").exists() {
        let mut install = command::program(python);
        install.args(["-m", "pip", "install", "--quiet", "--no-deps"]);
        install.args(["--disable-pip-version-check", "--target"]).arg(&folder);
        command::run(install.arg(OLDER_GYMNASIUM))?;
    }
    Ok(folder)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tests_that_import_gymnasium_run_with_the_older_release_too() {
        let files = of_gymnasium(&workspace::root().join("python/tests")).unwrap();
        let names: Vec<_> = files.iter().filter_map(|file| file.file_name()?.to_str()).collect();
        assert_eq!(
            names,
            [
                "test_attributes.py",
                "test_check_vector_env.py",
                "test_classic_attributes.py",
                "test_classic_control.py",
                "test_copies.py",
                "test_custom.py",
                "test_environment_errors.py",
                "test_environment_pages.py",
                "test_first_hour.py",
                "test_gymnasium_vector_suite.py",
                "test_gymnasium_vector_wrappers.py",
                "test_probe_gymnasium.py",
                "test_probe_gymnasium_wrappers.py",
                "test_sb3.py",
                "test_spaces.py",
                "test_specs.py",
                "test_system_environments.py",
                "test_vector.py"
            ]
        );
    }

    #[test]
    fn a_folder_without_them_is_an_error() {
        let scratch = crate::scratch::Scratch::new("of-gymnasium").unwrap();
        assert!(of_gymnasium(scratch.path()).is_err());
        fs::write(scratch.path().join("test_a.py"), "import numpy\n# import gymnasium\n").unwrap();
        assert!(of_gymnasium(scratch.path()).is_err());
        fs::write(scratch.path().join("test_b.py"), "from gymnasium import spaces\n").unwrap();
        assert_eq!(of_gymnasium(scratch.path()).unwrap(), [scratch.path().join("test_b.py")]);
    }

    #[test]
    fn each_file_of_tests_is_run_by_one_process_and_those_that_take_longest_are_apart() {
        let files = files_in(&workspace::root().join("python/tests")).unwrap();
        let processes = divided(files.clone());
        let mut all = processes.concat();
        all.sort();
        assert_eq!(all, files);
        for long in LONG {
            assert!(files.iter().any(|file| name(file) == long), "{long} is no test");
        }
        for (process, long) in processes.iter().zip(LONG) {
            assert_eq!(name(&process[0]), long);
        }
    }
}
