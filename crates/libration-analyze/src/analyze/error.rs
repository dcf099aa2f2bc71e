//! Why there is no analysis.

use libration::CatalogError;
use libration::control::Latency;
use libration::simulation::SimulationError;
use libration_settings::limits;
use thiserror::Error;

/// Why there is no analysis.
#[derive(Debug, Error)]
pub enum AnalyzeError {
    /// The system does not exist in as many dimensions as there are coordinates.
    #[error(transparent)]
    Dimension(#[from] CatalogError),
    /// Positions and velocities differ in number.
    #[error("{q} positions but {v} velocities: expected as many of the one as of the other")]
    Coordinates {
        /// Number of positions.
        q: usize,
        /// Number of velocities.
        v: usize,
    },
    /// The time step or the start is not usable.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// A criterion was given for a system whose largest time step is not known in closed form.
    #[error(
        "--{flag} is answered for the system `oscillator` with k or omega2 above 0 (--system, --set); this is `{system}`"
    )]
    Criterion {
        /// The flag.
        flag: &'static str,
        /// The system.
        system: &'static str,
    },
    /// A criterion was given for exact steps.
    #[error("--{flag} asks for the largest step, which `exact` steps (--integrator) do not have")]
    NoLargest {
        /// The criterion.
        flag: &'static str,
    },
    /// Exact steps were asked of a system that is not linear.
    #[error("`exact` steps (--integrator) exist of linear systems, not of `{system}`")]
    NotLinear {
        /// The system.
        system: &'static str,
    },
    /// Timing was asked of a system with several degrees of freedom.
    #[error(
        "--{flag} is answered for systems with one degree of freedom, not for `{system}` with {dimension}"
    )]
    Loop {
        /// The flag.
        flag: &'static str,
        /// The system.
        system: &'static str,
        /// Its degrees of freedom here.
        dimension: usize,
    },
    /// The fastest motion turns too far in a step.
    #[error(
        "`dt` is {dt:e} s, in which the fastest motion turns by {turn:.3e} rad; expected at most {:e} rad, a dt of {:.3e} s",
        limits::MOST_TURN, dt / turn * limits::MOST_TURN
    )]
    Turn {
        /// The step, in s.
        dt: f64,
        /// The angle.
        turn: f64,
    },
    /// A number of a loop is too large or too small for theory.
    #[error("{name} is {value:e}; expected {zero}{:e} to {:e} in size", limits::SIZE.start(), limits::SIZE.end())]
    Size {
        /// The parameter, or `dt`.
        name: &'static str,
        /// Its value.
        value: f64,
        /// The other value that is allowed, if 0 is.
        zero: &'static str,
    },
    /// There is no such latency.
    #[error("--latency is {steps:?} steps, but must be a number from 0 to {}", Latency::MOST_STEPS)]
    Latency {
        /// In steps.
        steps: f64,
    },
    /// The caller stopped it.
    #[error("interrupted")]
    Interrupted,
    /// The Jacobian does not exist at this state.
    #[error(
        "the step cannot be linearised about q = {q:?} (--q), v = {v:?} (--v): the force or its \
         derivative does not exist there or after a step from there; {allowed}"
    )]
    Singular {
        /// What a start must be.
        allowed: &'static str,
        /// Positions.
        q: Vec<f64>,
        /// Velocities.
        v: Vec<f64>,
    },
}
