//! Steps of an integrator on a system by its program.

use libration::Elementary;
use libration::equations::{Dynamics, Evaluation, StepProgram};

/// A trajectory whose inputs are zero, on numbers of type `S`.
#[derive(Debug)]
pub(crate) struct ProgramStepper<'p, S> {
    step: Evaluation<'p, S>,
    /// Positions, velocities, inputs and the time step.
    inputs: Vec<S>,
    /// Number of positions and velocities.
    states: usize,
    next: Vec<S>,
}

impl<'p, S: Elementary> ProgramStepper<'p, S> {
    /// From positions and velocities.
    pub(crate) fn new(step: &'p StepProgram, dynamics: &Dynamics, start: &[S]) -> Self {
        let mut inputs = start.to_vec();
        inputs.resize(start.len() + dynamics.inputs() + 1, S::zero());
        let next = Vec::with_capacity(start.len());
        ProgramStepper { step: step.program().on(), inputs, states: start.len(), next }
    }

    /// Positions and velocities after a step of `dt` seconds.
    pub(crate) fn step(&mut self, dt: S) -> &[S] {
        let ProgramStepper { step, inputs, next, .. } = self;
        if let Some(last) = inputs.last_mut() {
            *last = dt;
        }
        next.clear();
        next.extend(step.run(inputs));
        inputs[..next.len()].copy_from_slice(next);
        self.state()
    }

    /// Positions and velocities.
    pub(crate) fn state(&self) -> &[S] {
        &self.inputs[..self.states]
    }
}
