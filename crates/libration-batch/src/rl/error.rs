//! What can be wrong with environments.

use libration_core::Float;
use libration_core::control::ControlError;
use thiserror::Error;

use crate::ensemble::{EnsembleError, InsufficientMemory};

/// Why environments or a rollout cannot be made or run.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum EnvironmentError {
    /// As for every ensemble.
    #[error(transparent)]
    Ensemble(#[from] EnsembleError),
    /// A number cannot be so.
    #[error(transparent)]
    Number(#[from] ControlError),
    /// There are more or fewer of something.
    #[error("the number of {name} is {found}; it must be {wanted}")]
    Shape {
        /// Of what.
        name: &'static str,
        /// How many there are.
        found: usize,
        /// How many there must be.
        wanted: usize,
    },
    /// There is no room to say something that has to be said.
    #[error("{why}: the rollout requires the field `{field}`")]
    Field {
        /// Why it has to be said.
        why: &'static str,
        /// Which of its fields is missing.
        field: &'static str,
    },
    /// A rollout that does not fit.
    #[error(
        "a rollout of {horizon} steps of {environments} environments takes {bytes} bytes per transition. {room}. {}",
        advice(*bytes, *horizon, *environments, room)
    )]
    Room {
        /// Steps that were asked for.
        horizon: usize,
        /// Environments that were asked for.
        environments: usize,
        /// Bytes of a transition.
        bytes: usize,
        /// What is missing.
        room: InsufficientMemory,
    },
    /// What is listed by number is asked for where numbers are no more.
    #[error(
        "clock rates are listed per environment, and seeds per environment make every environment the first of a batch: \
         draw the rates from a distribution, or use one seed for the batch"
    )]
    Seeded,
    /// A time limit of nothing.
    #[error("the time limit is 0 actions; it must be at least 1, or absent")]
    Limit,
}

impl From<InsufficientMemory> for EnvironmentError {
    fn from(error: InsufficientMemory) -> Self {
        EnsembleError::from(error).into()
    }
}

impl EnvironmentError {
    /// The memory that is missing, if it is that.
    pub fn room(&self) -> Option<&InsufficientMemory> {
        match self {
            EnvironmentError::Room { room, .. } => Some(room),
            EnvironmentError::Ensemble(EnsembleError::Memory(room)) => Some(room),
            _ => None,
        }
    }

    /// Nothing, if there are as many as there must be.
    pub(super) fn shape(name: &'static str, found: usize, wanted: usize) -> Result<(), Self> {
        if found == wanted { Ok(()) } else { Err(EnvironmentError::Shape { name, found, wanted }) }
    }

    /// Nothing, if the number is one above zero, in the float type as well.
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

/// What is allowed of the random words of what does not draw.
pub(super) const NOTHING_DRAWN: &str = "0 unless `DRAWS` is true";

/// What would fit.
fn advice(bytes: usize, horizon: usize, environments: usize, room: &InsufficientMemory) -> String {
    let Some(available) = room.available else {
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
