//! Errors of temperatures.

use libration_work::Interrupted;
use thiserror::Error;

/// Error of an analysis of temperatures.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum TemperatureError {
    /// A number of the request is not allowed.
    #[error("{name} {value}: expected a finite number greater than 0{reason}")]
    Number {
        /// The name.
        name: &'static str,
        /// The value.
        value: f64,
        /// Why, if that is not clear; empty otherwise.
        reason: &'static str,
    },
    /// The time step is too short for the slowest mode.
    #[error(
        "dt {dt:e}: expected at least {} s: below, rounding hides the temperature of the slowest mode", super::significant(*.least)
    )]
    Resolution {
        /// The time step in s.
        dt: f64,
        /// The least one in s.
        least: f64,
    },
    /// The number of steps is out of range.
    #[error("steps {steps}: expected {TRAJECTORIES} to 1e10", TRAJECTORIES = super::TRAJECTORIES)]
    Steps {
        /// The number.
        steps: u64,
    },
    /// No thermostat is given.
    #[error("no thermostat; expected at least one")]
    NoThermostat,
    /// Forces depend on velocities.
    #[error(
        "{system} has a force that depends on a velocity, such as damping; expected forces of positions: friction is that of the thermostat"
    )]
    Velocity {
        /// The name of the system.
        system: String,
    },
    /// Forces depend on time.
    #[error("{system} has a force that depends on time; expected forces of positions")]
    Time {
        /// The name of the system.
        system: String,
    },
    /// A state of first order.
    #[error("{system} has the state `{state}` of first order; expected coordinates only")]
    FirstOrder {
        /// The name of the system.
        system: String,
        /// The name of the state.
        state: String,
    },
    /// There is no state at rest near the start.
    #[error(
        "{system} has no equilibrium near its start; expected a minimum of the potential; help: start near one"
    )]
    NoEquilibrium {
        /// The name of the system.
        system: String,
    },
    /// The state at rest is not stable.
    #[error(
        "the equilibrium of {system} at {positions:?} is not stable: the square of a frequency is {square:.3e} /s²; expected more than 0 for all; help: start near a minimum of the potential"
    )]
    Unstable {
        /// The name of the system.
        system: String,
        /// The positions.
        positions: Vec<f64>,
        /// The least square of a frequency.
        square: f64,
    },
    /// The state at rest has a direction without stiffness.
    #[error(
        "the equilibrium of {system} at {positions:?} has no stiffness in a direction: the square of a frequency is {square:.3e} /s²; expected a minimum that is quadratic in all directions, not flat or of fourth order; help: add a linear force, or choose another start"
    )]
    NoStiffness {
        /// The name of the system.
        system: String,
        /// The positions.
        positions: Vec<f64>,
        /// The least square of a frequency.
        square: f64,
    },
    /// Forces have no potential.
    #[error(
        "{system} has forces without a potential: no temperature is stationary; expected forces that are the slope of a potential{help}"
    )]
    NoPotential {
        /// The name of the system.
        system: String,
        /// What may be missing.
        help: &'static str,
    },
    /// Masses depend on the state, or are not positive.
    #[error("{system} has {problem}; expected a kinetic energy of constant, positive masses")]
    Mass {
        /// The name of the system.
        system: String,
        /// What is wrong.
        problem: &'static str,
    },
    /// The user stopped the work.
    #[error("interrupted")]
    Interrupted,
}

impl From<Interrupted> for TemperatureError {
    fn from(_: Interrupted) -> Self {
        TemperatureError::Interrupted
    }
}
