//! The programs of a motion with adaptive steps.

use libration::equations::{Dynamics, Flow, Program, StepProgram, VectorStep};
use libration::{Method, with_method};

/// The programs of a motion with adaptive steps.
#[derive(Debug)]
pub struct AdaptivePrograms {
    pub(super) dynamics: Dynamics,
    pub(super) step: StepProgram,
    pub(super) frequency: Program,
    /// The kicks and drifts of the method, if it is a sequence of them.
    pub(super) flows: Option<Vec<Flow>>,
}

impl AdaptivePrograms {
    /// Those of an integrator on a system whose inputs are zero.
    pub fn new(dynamics: &Dynamics, method: Method) -> Self {
        AdaptivePrograms {
            step: StepProgram::new(method, dynamics),
            frequency: dynamics.fourth_power_of_frequency(),
            flows: with_method!(method, |integrator| VectorStep::flows(integrator)),
            dynamics: dynamics.clone(),
        }
    }

    /// Whether a step of the integrator is the same backwards: a sequence of kicks and drifts that is a palindrome.
    pub fn is_symmetric(&self) -> bool {
        let flows = self.flows.as_deref().unwrap_or_default();
        !flows.is_empty() && flows.iter().eq(flows.iter().rev())
    }
}
