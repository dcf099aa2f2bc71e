//! Environments of either float type.

use libration::ensemble::Execution;
use libration::rl::EnvironmentError;
use libration_env::environments::{AnyEnvironments, EnvironmentSettings};

/// A batch of either float type.
pub(crate) enum AnyBatch {
    F32(Box<dyn AnyEnvironments<f32>>),
    F64(Box<dyn AnyEnvironments<f64>>),
}

/// Evaluates an expression for a batch of either float type.
macro_rules! with_batch {
    ($batch:expr, $any:ident => $work:expr) => {
        match $batch {
            $crate::any_batch::AnyBatch::F32($any) => $work,
            $crate::any_batch::AnyBatch::F64($any) => $work,
        }
    };
}
pub(crate) use with_batch;

impl AnyBatch {
    /// Returns environments of these settings.
    pub(crate) fn new(
        environments: &EnvironmentSettings,
        single: bool,
        len: usize,
        execution: &Execution,
    ) -> Result<Self, EnvironmentError> {
        let which = ([0, len], 0, execution);
        Ok(match single {
            true => AnyBatch::F32(environments.build(which)?),
            false => AnyBatch::F64(environments.build(which)?),
        })
    }
}
