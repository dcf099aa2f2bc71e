//! Errors of environments and rollouts.

use libration_core::Float;
use libration_core::control::ControlError;
use thiserror::Error;

use crate::ensemble::{EnsembleError, InsufficientMemory};

/// Error of environments or of a rollout.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum EnvironmentError {
    /// An error of an ensemble.
    #[error(transparent)]
    Ensemble(#[from] EnsembleError),
    /// An invalid parameter.
    #[error(transparent)]
    Number(#[from] ControlError),
    /// A length is wrong.
    #[error("the number of {name} is {found}; it must be {wanted}")]
    Shape {
        /// The name of the values.
        name: &'static str,
        /// The number of values.
        found: usize,
        /// The required number.
        wanted: usize,
    },
    /// The rollout lacks a required field.
    #[error("{why}: the rollout requires the field `{field}`")]
    Field {
        /// The reason.
        why: &'static str,
        /// The missing field.
        field: &'static str,
    },
    /// The memory is insufficient for the rollout.
    #[error(
        "a rollout of {horizon} steps of {environments} environments takes {bytes} bytes per transition. {shortage}. {}",
        advice(*bytes, *horizon, *environments, shortage)
    )]
    OutOfMemory {
        /// The number of steps.
        horizon: usize,
        /// The number of environments.
        environments: usize,
        /// Bytes of a transition.
        bytes: usize,
        /// The memory that is needed and available.
        shortage: InsufficientMemory,
    },
    /// Clock rates per environment are combined with seeds per environment.
    #[error(
        "clock rates are listed per environment, and seeds per environment make every environment the first of a batch: \
         draw the rates from a distribution, or use one seed for the batch"
    )]
    Seeded,
    /// The task of a system that waits for its answers depends on time.
    #[error(
        "observation, reward or termination depends on the time t, which a system that waits for its answers does not count"
    )]
    Waits,
    /// The time limit is 0.
    #[error("the time limit is 0 actions; it must be at least 1, or absent")]
    Limit,
}

impl From<InsufficientMemory> for EnvironmentError {
    fn from(error: InsufficientMemory) -> Self {
        EnsembleError::from(error).into()
    }
}

impl EnvironmentError {
    /// The memory that is needed and available, if that is the error.
    pub fn insufficient_memory(&self) -> Option<&InsufficientMemory> {
        match self {
            EnvironmentError::OutOfMemory { shortage, .. } => Some(shortage),
            EnvironmentError::Ensemble(EnsembleError::Memory(shortage)) => Some(shortage),
            _ => None,
        }
    }

    /// Returns an error if `found` is not `wanted`.
    pub(super) fn shape(name: &'static str, found: usize, wanted: usize) -> Result<(), Self> {
        if found == wanted { Ok(()) } else { Err(EnvironmentError::Shape { name, found, wanted }) }
    }

    /// Returns an error unless the value is finite and above zero, in the float type as well.
    pub(super) fn above_zero<T: Float>(
        name: &'static str,
        index: usize,
        value: f64,
    ) -> Result<(), Self> {
        let held = T::from_f64(value);
        if value.is_finite() && held > T::zero() && held.is_finite() {
            return Ok(());
        }
        let allowed = "a finite number above 0";
        Err(ControlError { name, index: Some(index), value, allowed }.into())
    }
}

/// The allowed number of random words of a type that does not draw.
pub(super) const NOTHING_DRAWN: &str = "0 unless `DRAWS` is true";

/// The sizes that fit into the memory.
fn advice(
    bytes: usize,
    horizon: usize,
    environments: usize,
    shortage: &InsufficientMemory,
) -> String {
    let Some(available) = shortage.available else {
        return "Run the horizon in several parts".to_owned();
    };
    let fit = |by: usize| available / (bytes as u64).saturating_mul(by as u64).max(1);
    match [fit(environments), fit(horizon)] {
        [0, 0] => "The memory holds neither one step of these environments nor one environment over these steps".to_owned(),
        [0, fewer] => {
            format!("The memory holds {fewer} environments over these steps")
        }
        [pieces, 0] => format!(
            "The memory holds {pieces} steps of these environments: run the horizon in several parts"
        ),
        [pieces, fewer] => format!(
            "The memory holds {pieces} steps of these environments (run the horizon in several parts), or {fewer} \
             environments over these steps"
        ),
    }
}
