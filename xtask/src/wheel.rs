//! The Python package: its wheel, and its tests.

use std::fs;
use std::path::{Path, PathBuf};

use crate::{Outcome, command, python, workspace};

/// The release that the package is tested with besides the newest, which others pin.
const OLDER_GYMNASIUM: &str = "gymnasium==1.2.2";

/// Builds the wheel, installs it into the environment of the tests and runs those of the package with the newest Gymnasium, and with an older
/// one those that use it; `arguments`, which else are what there is for each, go to pytest.
pub(crate) fn test(arguments: &[String]) -> Outcome {
    let python = python::interpreter()?;
    install(&python)?;
    let older = older_gymnasium(&python)?;
    let folder = workspace::root().join("python/tests");
    for path in [None, Some(older)] {
        let mut tests = command::program(&python);
        // From within the folder of the tests: the package that is tested is the one that was installed.
        tests.args(["-m", "pytest", "-p", "no:cacheprovider"]).args(arguments);
        tests.current_dir(&folder);
        if let Some(path) = path {
            tests.env("PYTHONPATH", path);
            if arguments.is_empty() {
                tests.args(of_gymnasium(&folder)?);
            }
        }
        command::run(&mut tests)?;
    }
    Ok(())
}

/// The files of tests that import Gymnasium: the others say the same with any.
fn of_gymnasium(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let imports = |text: &str| {
        text.lines()
            .any(|line| ["import gymnasium", "from gymnasium"].iter().any(|i| line.starts_with(i)))
    };
    let unread = |error| format!("{} cannot be read: {error}", folder.display());
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).map_err(unread)? {
        let path = entry.map_err(unread)?.path();
        if path.is_file() && imports(&fs::read_to_string(&path).map_err(unread)?) {
            files.push(path);
        }
    }
    files.sort();
    if files.is_empty() { Err("no test imports Gymnasium".to_owned()) } else { Ok(files) }
}

/// Builds the wheel of what the tests of the workspace have compiled, and installs it.
fn install(python: &Path) -> Outcome {
    let wheels = workspace::target().join("wheels");
    // It may not be there.
    let _ = fs::remove_dir_all(&wheels);
    let mut build = command::program(python);
    build.args(["-m", "maturin", "build", "--quiet", "--profile", "dev"]);
    build.args(["--features", "as-tested", "--compatibility", "linux", "--interpreter"]);
    command::run(build.arg(python).arg("--out").arg(&wheels))?;
    let files = fs::read_dir(&wheels).into_iter().flatten().flatten().map(|entry| entry.path());
    let wheel = files.last().ok_or("maturin has built no wheel")?;
    let mut install = command::program(python);
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
    fn tests_that_import_gymnasium_are_those_of_the_contract_of_custom_tasks_of_audits_and_of_equations()
     {
        let files = of_gymnasium(&workspace::root().join("python/tests")).unwrap();
        let names: Vec<_> = files.iter().filter_map(|file| file.file_name()?.to_str()).collect();
        assert_eq!(
            names,
            [
                "test_custom.py",
                "test_probe_gymnasium.py",
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
}
