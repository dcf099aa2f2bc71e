//! Steps of integrators for the machine.

use libration_core::{AnyMethod, with_method};
use libration_equations::{Dynamics, StepProgram};

use super::BlockProgram;

/// A step for the machine, with its way from accelerations to accelerations where there is one.
#[derive(Debug)]
pub(crate) struct MachineStep {
    pub(crate) step: BlockProgram,
    /// The program of the accelerations at the start, if the step takes them.
    pub(crate) first: Option<BlockProgram>,
}

impl MachineStep {
    /// To evaluate the accelerations at the start costs what a step saves: a single step is better off without.
    pub(crate) fn new(method: AnyMethod, dynamics: &Dynamics, carries: bool) -> Self {
        let degrees = dynamics.degrees();
        let carrying = match method {
            AnyMethod::Explicit(method) => {
                with_method!(method, |method| StepProgram::carrying(method, dynamics))
            }
            AnyMethod::Implicit(_) => None,
        };
        match carrying.filter(|_| carries) {
            Some(carrying) => {
                let rows = 3 * degrees;
                let targets: Vec<usize> = (0..rows).collect();
                let row_of = |i: usize| (i < rows).then_some(i);
                let first = BlockProgram::new(
                    dynamics.accelerations(),
                    |i| (i < 2 * degrees).then_some(i),
                    &targets[2 * degrees..],
                    rows,
                );
                let step = BlockProgram::new(carrying.program(), row_of, &targets, rows);
                MachineStep { step, first: Some(first) }
            }
            None => MachineStep::of_program(&StepProgram::of(method, dynamics), degrees),
        }
    }

    /// A step by its program.
    pub(crate) fn of_program(program: &StepProgram, degrees: usize) -> Self {
        let rows = 2 * degrees;
        let targets: Vec<usize> = (0..rows).collect();
        let row_of = |i: usize| (i < rows).then_some(i);
        let step = BlockProgram::new(program.program(), row_of, &targets, rows);
        MachineStep { step, first: None }
    }

    /// The number of inputs before the time step.
    pub(crate) fn inputs(&self, dynamics: &Dynamics) -> usize {
        let vectors = if self.first.is_some() { 3 } else { 2 };
        vectors * dynamics.degrees() + dynamics.inputs()
    }
}
