//! Errors of an analysis.

use libration::control::Latency;
use libration::simulation::SimulationError;
use libration_settings::limits;
use thiserror::Error;

/// Error of an analysis.
#[derive(Debug, Error)]
pub enum AnalyzeError {
    /// The time step or the start is invalid.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// A criterion for a system without a closed form of the largest time step.
    #[error(
        "--{flag} requires oscillators, as the system `oscillator` with k or omega2 above 0: accelerations −ω²q, and an energy v²/2 + ω²q²/2 in each coordinate; `{system}` has others"
    )]
    Criterion {
        /// The flag.
        flag: &'static str,
        /// The system.
        system: String,
    },
    /// A criterion for exact steps.
    #[error("--{flag} limits the time step, and `exact` steps (--integrator) have no limit")]
    NoLargest {
        /// The criterion.
        flag: &'static str,
    },
    /// A criterion or a loop with implicit steps.
    #[error(
        "--integrator {integrator}: implicit integrators have no --{flag}; expected an explicit integrator, such as `rk4`, with it"
    )]
    Implicit {
        /// The flag of the criterion or of the loop.
        flag: &'static str,
        /// The integrator.
        integrator: &'static str,
    },
    /// Implicit steps of a system with too many degrees of freedom.
    #[error(
        "the implicit integrator `{integrator}` (--integrator) has steps for at most {most} degrees of freedom, and the system has {degrees}"
    )]
    ImplicitDegrees {
        /// The integrator.
        integrator: &'static str,
        /// The most degrees of freedom of its steps.
        most: usize,
        /// Those of the system.
        degrees: usize,
    },
    /// Exact steps of a nonlinear system.
    #[error("`exact` steps (--integrator) require a linear system, not `{system}`")]
    NotLinear {
        /// The system.
        system: String,
    },
    /// Timing options for a system with several degrees of freedom.
    #[error("--{flag} requires one degree of freedom, and `{system}` has {dimension}")]
    Loop {
        /// The flag.
        flag: &'static str,
        /// The system.
        system: String,
        /// Its degrees of freedom.
        dimension: usize,
    },
    /// The fastest motion turns by a too large angle per step.
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
    /// A number of a loop is too large or too small.
    #[error("{name} is {value:e}; expected {zero}{:e} to {:e} in size", limits::SIZE.start(), limits::SIZE.end())]
    Size {
        /// The parameter, or `dt`.
        name: &'static str,
        /// Its value.
        value: f64,
        /// `0, or ` if 0 is allowed.
        zero: &'static str,
    },
    /// The latency is invalid.
    #[error("--latency is {steps:?} steps; expected 0 to {}", Latency::MOST_STEPS)]
    Latency {
        /// In steps.
        steps: f64,
    },
    /// The latency is far too long for the step, in words.
    #[error("--latency: {0}")]
    ExcessiveLatency(String),
    /// The caller stopped the analysis.
    #[error("interrupted")]
    Interrupted,
    /// The Jacobian does not exist at this state.
    #[error(
        "the step cannot be linearised about q = {q:?} (--q), v = {v:?} (--v): the force or its \
         derivative does not exist there or after a step from there; {allowed}"
    )]
    Singular {
        /// The allowed starts, in words.
        allowed: &'static str,
        /// Positions.
        q: Vec<f64>,
        /// Velocities.
        v: Vec<f64>,
    },
}
