//! What goes wrong, as Python has it.

use libration::checkpoint::CheckpointError;
use libration::ensemble::EnsembleError;
use libration::rl::EnvironmentError;
use pyo3::PyErr;
use pyo3::exceptions::{PyMemoryError, PyRuntimeError, PyValueError};

/// Every error of the engine is turned into an exception here, and nowhere else.
pub(crate) trait Raised {
    /// The exception.
    fn raised(self) -> PyErr;
}

impl Raised for EnvironmentError {
    fn raised(self) -> PyErr {
        let text = self.to_string();
        match self {
            EnvironmentError::Room { .. }
            | EnvironmentError::Ensemble(EnsembleError::Memory(_)) => PyMemoryError::new_err(text),
            EnvironmentError::Ensemble(EnsembleError::Threads { .. }) => {
                PyRuntimeError::new_err(text)
            }
            _ => PyValueError::new_err(text),
        }
    }
}

impl Raised for CheckpointError {
    fn raised(self) -> PyErr {
        PyValueError::new_err(self.to_string())
    }
}

/// What cannot be asked for.
pub(crate) fn refused(text: String) -> PyErr {
    PyValueError::new_err(text)
}
