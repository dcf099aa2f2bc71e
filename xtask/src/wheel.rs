//! The Python package: its wheel, and its tests.

use std::fs;
use std::path::{Path, PathBuf};

use crate::{Outcome, command, python, workspace};

/// The release that the package is tested with besides the newest, which others pin.
const OLDER_GYMNASIUM: &str = "gymnasium==1.2.2";

/// Tests of what has nothing to do with Gymnasium.
const APART: [&str; 3] = ["test_laboratory.py", "test_replay.py", "test_simulation.py"];

/// Its types are written against those of the newest release.
const OF_THE_NEWEST: &str = "python/tests/test_stubs.py::test_the_package_agrees_with_its_types";

/// Builds the wheel, installs it into the environment of the tests and runs those of the package, with the newest Gymnasium and with an
/// older one; `arguments`, which else are what there is for each, go to pytest.
pub(crate) fn test(arguments: &[String]) -> Outcome {
    let python = python::interpreter()?;
    install(&python)?;
    let older = older_gymnasium(&python)?;
    for path in [None, Some(older)] {
        let mut tests = command::program(&python);
        // From within the folder of the tests: the package that is tested is the one that was installed.
        tests.args(["-m", "pytest", "-p", "no:cacheprovider"]).args(arguments);
        tests.current_dir(workspace::root().join("python/tests"));
        if let Some(path) = path {
            tests.env("PYTHONPATH", path);
            if arguments.is_empty() {
                tests.args(APART.map(|file| format!("--ignore={file}")));
                tests.args(["--deselect", OF_THE_NEWEST]);
            }
        }
        command::run(&mut tests)?;
    }
    Ok(())
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
