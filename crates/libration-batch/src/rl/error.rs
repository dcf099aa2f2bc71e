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
    #[error("{why}: the rollout must have room for `{field}`")]
    Field {
        /// Why it has to be said.
        why: &'static str,
        /// Which of its fields is missing.
        field: &'static str,
    },
    /// A rollout that does not fit.
    #[error(
        "a rollout of {horizon} steps of {environments} environments takes {bytes} bytes a transition. {room}. {}",
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
        "rates of clocks are listed by the numbers of environments, and a seed of its own makes every environment the first of a batch: \
         draw the rates from a law, or give the batch one seed"
    )]
    Seeded,
    /// A time limit of nothing.
    #[error("the time limit is 0 actions; it must be at least 1, or there must be none")]
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
pub(super) const NOTHING_DRAWN: &str = "0, unless it says that it draws";

/// What would fit.
fn advice(bytes: usize, horizon: usize, environments: usize, room: &InsufficientMemory) -> String {
    let Some(available) = room.available else {
        return "A horizon can be run in pieces, one after the other".to_owned();
    };
    let fit = |by: usize| available / (bytes as u64).saturating_mul(by as u64).max(1);
    match [fit(environments), fit(horizon)] {
        [0, 0] => "There is no room for a single step of so many environments, nor for a single one over so many steps".to_owned(),
        [0, fewer] => {
            format!("There is room for {fewer} environments over so many steps")
        }
        [pieces, 0] => format!(
            "There is room for {pieces} steps of so many environments, which can be run one after the other"
        ),
        [pieces, fewer] => format!(
            "There is room for {pieces} steps of so many environments, which can be run one after the other, or for {fewer} \
             environments over so many steps"
        ),
    }
}
