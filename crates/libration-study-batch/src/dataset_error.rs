//! Errors of studies that write data sets.

use libration_env::dataset::DatasetError;
use libration_study::StudyError;

/// The error of a study whose data set or file failed.
pub(crate) fn failed(error: impl Into<DatasetError>) -> StudyError {
    match error.into() {
        DatasetError::Interrupted => StudyError::Interrupted,
        error => StudyError::Other(Box::new(error)),
    }
}
