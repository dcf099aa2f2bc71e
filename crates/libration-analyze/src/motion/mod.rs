//! A motion under steps of an integrator beside the exact motion, over all steps of a request.

mod adaptive_reference;
mod energy;
mod examination;
mod judgement;
mod narrow_force;
mod reference;
mod sample_steps;
mod step_run;
mod undefined_function;
mod unseen;

use libration::equations::{Degree, Dynamics, StepProgram};
use libration_settings::equations::{EquationSystem, NamedState};

pub use energy::EnergyChange;
pub(crate) use energy::{EnergyOf, EnergyScale};
pub(crate) use examination::examine;
pub use examination::{MotionExamination, StateExamination};
pub use narrow_force::narrow_force;
pub(crate) use step_run::StepRun;
pub(crate) use undefined_function::undefined_function;

/// Steps of a nonlinear motion without a number in the request: more are a choice of the user, since errors of most motions grow.
pub const DEFAULT_STEPS: u64 = 1000;

/// The part of the range of a state up to which an error is small beside its motion: the width of a line in a plot. Twice as much of an
/// amplitude.
const SMALL: f64 = 0.01;

/// A system with the start of its motion.
pub(crate) struct MotionSubject<'a> {
    pub(crate) dynamics: &'a Dynamics,
    /// Positions, velocities and inputs.
    pub(crate) start: &'a [f64],
    /// The states that count.
    pub(crate) states: &'a [MotionState],
    /// Whether accelerations are sums of constants times states, and of constants.
    pub(crate) is_affine: bool,
    /// The unit of the energy; empty without one.
    pub(crate) energy_unit: &'a str,
}

/// A state of a motion.
pub(crate) struct MotionState {
    /// The place among positions and velocities.
    pub(crate) place: usize,
    pub(crate) name: String,
    /// The unit; empty without one.
    pub(crate) unit: String,
    pub(crate) is_velocity: bool,
}

impl MotionState {
    /// The states of a system.
    pub(crate) fn all(system: &EquationSystem) -> Vec<Self> {
        let degrees = system.equations.degrees();
        let is_velocity = |place: usize| {
            let degree = place.checked_sub(degrees.len()).map(|degree| &degrees[degree]);
            matches!(degree, Some(Degree::Coordinate(_)))
        };
        let state = |state: &NamedState| MotionState {
            place: state.place,
            name: state.name.clone(),
            unit: state.unit.clone(),
            is_velocity: is_velocity(state.place),
        };
        system.states.iter().map(state).collect()
    }

    /// Whether values of both are of one kind: equal units, and without units both positions or both velocities.
    fn is_like(&self, other: &MotionState) -> bool {
        self.unit == other.unit && (!self.unit.is_empty() || self.is_velocity == other.is_velocity)
    }
}

/// Operations of all steps of a motion: less than a second.
const MOST_OPERATIONS: u64 = 1 << 29;

/// The most steps of a motion that are taken, also as half and as quarter steps.
pub(crate) fn most_steps(step: &StepProgram) -> u64 {
    (MOST_OPERATIONS / (step.program().operations().max(1) as u64 * 7)).max(1)
}
