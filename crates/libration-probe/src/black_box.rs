//! The step of a simulator that is known by its results alone.

use libration::linear::Matrix;
use thiserror::Error;

/// A step of any simulator: from states and actions to the states one step later.
pub trait BlackBox {
    /// The states `dt` seconds later under constant actions: a row for each row of `states` and `actions`, in the same order.
    ///
    /// # Errors
    /// The simulator fails.
    fn step(&mut self, states: &Matrix, actions: &Matrix, dt: f64)
    -> Result<Matrix, BlackBoxError>;

    /// Whether all rows of a call reach the simulator at once, as a batch.
    fn is_batched(&self) -> bool {
        false
    }

    /// The observation of each state, if there are observations besides the states.
    ///
    /// # Errors
    /// The simulator fails.
    fn observe(&mut self, _states: &Matrix) -> Result<Option<Matrix>, BlackBoxError> {
        Ok(None)
    }

    /// The energy of each state, if it is known.
    ///
    /// # Errors
    /// The simulator fails.
    fn energies(&mut self, _states: &Matrix) -> Result<Option<Vec<f64>>, BlackBoxError> {
        Ok(None)
    }

    /// Sets the gains of position and velocity of all servos, with their forces at the point as they are; false if this is not possible.
    ///
    /// # Errors
    /// The simulator fails.
    fn set_gains(&mut self, _kp: &[f64], _kv: &[f64]) -> Result<bool, BlackBoxError> {
        Ok(false)
    }

    /// Starts the simulator anew, as a new process; false if this is not possible.
    ///
    /// # Errors
    /// The simulator does not start.
    fn restart(&mut self) -> Result<bool, BlackBoxError> {
        Ok(false)
    }
}

/// Failure of a black box.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum BlackBoxError {
    /// The simulator failed, in its own words.
    #[error("{0}")]
    Failed(String),
    /// The audit has no time left for an answer.
    #[error("`{program}` gave no answer before the limit of time of the audit")]
    TimeLimit {
        /// The program.
        program: String,
    },
    /// An answer took too long.
    #[error(
        "`{program}` gave no answer within {seconds} s; expected a line for each line, flushed at once"
    )]
    NoAnswer {
        /// The program.
        program: String,
        /// The time that an answer has.
        seconds: f64,
    },
    /// A result has the wrong shape.
    #[error("the {what} of {rows} states are {found}; expected {expected}")]
    Shape {
        /// Next states, observations or energies.
        what: &'static str,
        /// Number of states of the call.
        rows: usize,
        /// The shape of the result.
        found: String,
        /// The expected shape.
        expected: String,
    },
    /// A state is infinite or NaN.
    #[error(
        "the step of {dt:e} s from the state [{from}] has {value} in `{state}`; expected finite numbers; help: {help}"
    )]
    NotFinite {
        /// The length of the step.
        dt: f64,
        /// The state before.
        from: String,
        /// Infinite or NaN.
        value: f64,
        /// The name of the state.
        state: String,
        /// What to change.
        help: &'static str,
    },
}
