//! The virtual environment in which tests run their Python scripts.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::{Mutex, PoisonError};

use crate::{command, workspace};

/// Tried in this order; the environment copies the first that is recent enough.
const CANDIDATES: [&str; 2] = ["python3.11", "python3"];

const MISSING: &str = "Python 3.11 or newer was not found (tried `python3.11` and `python3`).
The tests compare the engine with plain NumPy scripts. Install Python, for example with
`apt install python3 python3-venv`, `dnf install python3` or `brew install python@3.11`.";

const NO_VENV: &str = "The virtual environment for the tests could not be made.
On Debian and Ubuntu the module `venv` is a package of its own: `apt install python3-venv`.";

const NO_PACKAGES: &str = "The packages in tools/requirements.txt could not be installed.
This happens once and needs a network or a pip that is set up to find them elsewhere.";

/// Held by the thread that makes the environment.
static MAKING: Mutex<()> = Mutex::new(());

/// The interpreter of the environment, which is made first where it is missing or out of date.
pub(crate) fn interpreter() -> Result<PathBuf, String> {
    let _making = MAKING.lock().unwrap_or_else(PoisonError::into_inner);
    let folder = workspace::target().join("python");
    let list = workspace::root().join("tools/requirements.txt");
    let requirements = fs::read_to_string(&list)
        .map_err(|error| format!("{} cannot be read: {error}", list.display()))?;
    let stamp = folder.join("installed.txt");
    let python = interpreter_in(&folder);
    if python.exists() && is_current(&stamp, &requirements) {
        return Ok(python);
    }

    let base = CANDIDATES.into_iter().find(|name| is_recent(name)).ok_or(MISSING)?;
    println!("Making a Python environment in {}", folder.display());
    command::run(command::program(base).args(["-m", "venv", "--clear"]).arg(&folder))
        .map_err(|error| format!("{error}\n{NO_VENV}"))?;
    let pip = ["-m", "pip", "install", "--quiet", "--no-input", "--disable-pip-version-check"];
    // Most modules are never imported.
    let mut install = command::program(&python);
    install.args(pip).args(["--no-compile", "--requirement"]).arg(&list);
    command::run(&mut install).map_err(|error| format!("{error}\n{NO_PACKAGES}"))?;
    // Written last: an environment without it is unfinished.
    fs::write(&stamp, &requirements)
        .map_err(|error| format!("{} cannot be written: {error}", stamp.display()))?;
    Ok(python)
}

fn interpreter_in(environment: &Path) -> PathBuf {
    environment.join(if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" })
}

/// Whether the environment holds exactly what the list asks for.
fn is_current(stamp: &Path, requirements: &str) -> bool {
    fs::read_to_string(stamp).is_ok_and(|installed| installed == requirements)
}

fn is_recent(python: &str) -> bool {
    Command::new(python)
        .args(["-c", "import sys; sys.exit(sys.version_info < (3, 11))"])
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .is_ok_and(|status| status.success())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scratch::Scratch;

    #[test]
    fn an_environment_is_current_only_with_the_stamp_of_the_same_requirements() {
        let scratch = Scratch::new("stamp").unwrap();
        let stamp = scratch.path().join("installed.txt");
        assert!(!is_current(&stamp, "numpy==1"));
        fs::write(&stamp, "numpy==1").unwrap();
        assert!(is_current(&stamp, "numpy==1"));
        assert!(!is_current(&stamp, "numpy==2"));
    }

    #[test]
    fn a_python_that_does_not_exist_is_not_recent() {
        assert!(!is_recent("python-that-does-not-exist"));
    }
}
