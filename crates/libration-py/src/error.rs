//! Conversion of errors to Python exceptions.

use libration::checkpoint::CheckpointError;
use libration::ensemble::{EnsembleError, InsufficientMemory};
use libration::replay::ReplayError;
use libration::rl::EnvironmentError;
use libration_advise::AdviseError;
use libration_analyze::AnalyzeError;
use libration_analyze::linear_analysis::LinearAnalysisError;
use libration_analyze::trajectory::TrajectoryError;
use libration_data::DataError;
use libration_env::dataset::DatasetError;
use libration_lab::output::OutputError;
use libration_lab::session::{Cause, SessionError};
use libration_settings::equations::StartError;
use libration_settings::{SettingsError, suggestions};
use libration_study::StudyError;
use pyo3::exceptions::{
    PyKeyboardInterrupt, PyMemoryError, PyOSError, PyRuntimeError, PyValueError,
};
use pyo3::{PyErr, PyResult};

/// Conversion of an error of the engine to an exception.
pub(crate) trait Raised {
    /// The exception.
    fn raised(self) -> PyErr;
}

impl Raised for EnvironmentError {
    fn raised(self) -> PyErr {
        let text = self.to_string();
        match self {
            EnvironmentError::OutOfMemory { .. }
            | EnvironmentError::Ensemble(EnsembleError::Memory(_)) => PyMemoryError::new_err(text),
            EnvironmentError::Ensemble(EnsembleError::Threads { .. }) => {
                PyRuntimeError::new_err(text)
            }
            _ => PyValueError::new_err(text),
        }
    }
}

impl Raised for EnsembleError {
    fn raised(self) -> PyErr {
        EnvironmentError::from(self).raised()
    }
}

impl Raised for CheckpointError {
    fn raised(self) -> PyErr {
        PyValueError::new_err(self.to_string())
    }
}

impl Raised for ReplayError {
    fn raised(self) -> PyErr {
        match self {
            ReplayError::Environment(error) => error.raised(),
            error => PyValueError::new_err(error.to_string()),
        }
    }
}

impl Raised for StartError {
    fn raised(self) -> PyErr {
        value_error(keywords(&self.to_string()))
    }
}

impl Raised for AnalyzeError {
    fn raised(self) -> PyErr {
        if matches!(self, AnalyzeError::Interrupted) {
            return interrupted();
        }
        value_error(keywords(&self.to_string()))
    }
}

impl Raised for LinearAnalysisError {
    fn raised(self) -> PyErr {
        match self {
            LinearAnalysisError::Interrupted => interrupted(),
            error => value_error(keywords(&error.to_string())),
        }
    }
}

impl Raised for TrajectoryError {
    fn raised(self) -> PyErr {
        match self {
            TrajectoryError::Ensemble(error) => error.raised(),
            TrajectoryError::Memory(_) => PyMemoryError::new_err(keywords(&self.to_string())),
            TrajectoryError::Interrupted => interrupted(),
            error => value_error(keywords(&error.to_string())),
        }
    }
}

impl Raised for SettingsError {
    fn raised(self) -> PyErr {
        let help = self.help().map(|help| format!(" ({help})")).unwrap_or_default();
        value_error(format!("{}{help}", self.message()))
    }
}

impl Raised for AdviseError {
    fn raised(self) -> PyErr {
        match self {
            AdviseError::Interrupted(_) => interrupted(),
            AdviseError::Ensemble(error) => error.raised(),
            error => value_error(error.to_string()),
        }
    }
}

impl Raised for StudyError {
    fn raised(self) -> PyErr {
        match self {
            StudyError::Interrupted => interrupted(),
            error => PyRuntimeError::new_err(error.to_string()),
        }
    }
}

impl Raised for SessionError {
    fn raised(self) -> PyErr {
        match *self.cause {
            Cause::Interrupted => interrupted(),
            Cause::Output(_) => PyOSError::new_err(self.to_string()),
            _ => PyRuntimeError::new_err(self.to_string()),
        }
    }
}

impl Raised for OutputError {
    fn raised(self) -> PyErr {
        PyOSError::new_err(format!("cannot write `{}`: {}", self.path.display(), self.source))
    }
}

impl Raised for DatasetError {
    fn raised(self) -> PyErr {
        match self {
            DatasetError::Interrupted => interrupted(),
            DatasetError::Environment(error) => error.raised(),
            DatasetError::Data(error @ DataError::Io { .. }) => {
                PyOSError::new_err(error.to_string())
            }
            error => value_error(keywords(&error.to_string())),
        }
    }
}

/// Returns the exception of interrupted work.
pub(crate) fn interrupted() -> PyErr {
    PyKeyboardInterrupt::new_err("interrupted")
}

/// Returns a `ValueError`.
pub(crate) fn value_error(text: String) -> PyErr {
    PyValueError::new_err(text)
}

/// Returns a `ValueError` for an unknown name, with the nearest known one.
pub(crate) fn unknown<'a>(
    what: &str,
    name: &str,
    known: impl IntoIterator<Item = &'a str> + Clone,
) -> PyErr {
    let hint = suggestions::suggest(&format!("{what}s"), name, known);
    value_error(format!("unknown {what} `{name}`: {hint}"))
}

/// Fails with a `MemoryError` if `bytes` are not available.
pub(crate) fn check_memory(bytes: u128) -> PyResult<()> {
    InsufficientMemory::check(bytes).map_err(|error| PyMemoryError::new_err(error.to_string()))
}

/// A sentence about flags, as one about keywords: what is `--max-drift` there is `max_drift` here, and a flag that goes on with something is
/// what is true.
pub(crate) fn keywords(text: &str) -> String {
    let text = &*text.replace("--resume", "resume=True");
    let mut words = text.split("--");
    let mut converted = words.next().unwrap_or_default().to_owned();
    for word in words {
        let end = word.find(|c: char| !(c.is_ascii_lowercase() || c == '-')).unwrap_or(word.len());
        converted += &word[..end].replace('-', "_");
        converted += &word[end..];
    }
    converted
}
