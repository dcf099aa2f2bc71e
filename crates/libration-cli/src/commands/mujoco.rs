//! MuJoCo models, which a Python program reads and steps.

use std::env;
use std::ffi::OsString;
use std::path::Path;
use std::time::{Duration, Instant};

use libration_probe::{BlackBoxError, ChildProcess};

use crate::error::Failure;

/// Python before 3.11 does not know `PYTHONSAFEPATH`, and searches modules of `-c` in the current folder: nothing is imported before it is
/// off the search path.
const PROGRAM: &str = "\
import sys
sys.path[:] = [folder for folder in sys.path if folder not in ('', '.')]
try:
    from libration.hosts.__main__ import main
except ModuleNotFoundError as error:
    help = f\"pip install 'libration[mujoco]' for this interpreter, {sys.executable}\"
    print(f'error: {error}; help: {help}', flush=True)
    sys.exit(2)
sys.exit(main())
";

/// `PYTHONPATH` without the current folder, which an empty or a relative entry stands for: Python also runs a `sitecustomize` from there.
fn search_path() -> Option<OsString> {
    let given = env::var_os("PYTHONPATH")?;
    let here = env::current_dir().and_then(|folder| folder.canonicalize()).ok();
    let elsewhere = |folder: &Path| {
        folder.is_absolute() && (here.is_none() || folder.canonicalize().ok() != here)
    };
    let kept = env::join_paths(env::split_paths(&given).filter(|folder| elsewhere(folder))).ok()?;
    Some(kept).filter(|kept| !kept.is_empty())
}
/// The least time that a Python program has to import its packages and to compile a model.
const LOADING: Duration = Duration::from_secs(60);

/// Starts the program for a model, and returns it with the first line of its output.
pub(super) fn start(
    python: &str,
    path: &Path,
    options: &[String],
    patience: Duration,
    deadline: Option<Instant>,
) -> Result<(ChildProcess, String), Failure> {
    if !path.is_file() {
        return Err(Failure::usage(format!(
            "cannot use `{}` (--mujoco): there is no such file; expected a model as XML or MJB",
            path.display()
        )));
    }
    // A model is often in a folder that somebody downloaded, whose files are no modules.
    let mut words: Vec<String> = [python, "-c", PROGRAM, "mujoco"].map(str::to_owned).into();
    let file = path.display().to_string();
    words.push(if file.starts_with('-') { format!("./{file}") } else { file });
    words.extend_from_slice(options);
    let environment =
        vec![("PYTHONSAFEPATH", Some(OsString::from("1"))), ("PYTHONPATH", search_path())];
    let mut child = ChildProcess::start(&words, environment, patience).map_err(|error| {
        Failure::usage(format!("{error}; expected --python with the packages libration and mujoco"))
    })?;
    if let Some(deadline) = deadline {
        child.set_deadline(deadline);
    }
    let line = child.description(LOADING).map_err(|error| match error {
        BlackBoxError::NoAnswer { .. } => Failure::run(format!(
            "{error} (--timeout); expected a description of the model; help: a longer --timeout"
        )),
        BlackBoxError::TimeLimit { .. } => {
            Failure::run(format!("{error} (--time-limit); expected a longer limit"))
        }
        _ => {
            Failure::run(format!("{error}; help: install the packages libration and mujoco for it"))
        }
    })?;
    match line.strip_prefix("error: ") {
        Some(message) => Err(Failure::usage(format!("{} (--mujoco)", message.trim_end()))),
        None => Ok((child, line)),
    }
}
