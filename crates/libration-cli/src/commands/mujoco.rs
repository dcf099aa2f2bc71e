//! MuJoCo models, which a Python program reads and steps.

use std::path::Path;
use std::time::{Duration, Instant};

use libration_probe::{BlackBoxError, ChildProcess};

use crate::error::Failure;

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
    let mut words: Vec<String> =
        [python, "-m", "libration.hosts", "mujoco"].map(str::to_owned).into();
    words.push(path.display().to_string());
    words.extend_from_slice(options);
    let mut child = ChildProcess::start(&words, patience).map_err(|error| {
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
