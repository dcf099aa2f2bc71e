//! Steps of integrators as programs.

use libration_core::{Integrator, State};

use super::Equations;
use super::program::{Operation, Program, ValueId};
use super::program_builder::ProgramBuilder;
use super::step_trace::{StepTrace, TracedSystem, VectorId, VectorOperation};

/// One step of an integrator on a system.
#[derive(Clone, Debug, PartialEq)]
pub struct StepProgram {
    /// From positions, velocities, inputs and the time step to positions and velocities.
    program: Program,
}

impl StepProgram {
    /// A step of `integrator` on a system, whose inputs are constant during the step.
    pub fn new(integrator: impl Integrator, equations: &Equations) -> Self {
        let trace = StepTrace::default();
        let (operations, [q, v]) = {
            let start = State {
                q: [trace.record(VectorOperation::Positions)],
                v: [trace.record(VectorOperation::Velocities)],
            };
            let dt = trace.record(VectorOperation::TimeStep);
            let end = integrator.step(&TracedSystem(&trace), start, dt);
            let ends = [trace.id(end.q[0]), trace.id(end.v[0])];
            (trace.into_operations(), ends)
        };
        let degrees = equations.degrees().len();
        let mut builder = ProgramBuilder::default();
        let mut inputs =
            |count: usize| -> Vec<ValueId> { (0..count).map(|_| builder.input()).collect() };
        let (positions, velocities) = (inputs(degrees), inputs(degrees));
        let commands = inputs(equations.inputs().len());
        let dt = inputs(1)[0];
        let mut vectors: Vec<Vec<ValueId>> = Vec::with_capacity(operations.len());
        for operation in operations {
            let two = |a: VectorId, b: VectorId| {
                vectors[a].iter().copied().zip(vectors[b].iter().copied())
            };
            let vector = match operation {
                VectorOperation::Positions => positions.clone(),
                VectorOperation::Velocities => velocities.clone(),
                VectorOperation::TimeStep => vec![dt; degrees],
                VectorOperation::Constant(c) => vec![builder.constant(c); degrees],
                VectorOperation::Sum(a, b) => {
                    two(a, b).map(|(a, b)| builder.value(Operation::Sum(a, b))).collect()
                }
                VectorOperation::Difference(a, b) => {
                    two(a, b).map(|(a, b)| builder.value(Operation::Difference(a, b))).collect()
                }
                VectorOperation::Product(a, b) => {
                    two(a, b).map(|(a, b)| builder.value(Operation::Product(a, b))).collect()
                }
                VectorOperation::Negative(a) => {
                    vectors[a].iter().map(|&a| builder.value(Operation::Negative(a))).collect()
                }
                VectorOperation::Ratio(a, num, den) => vectors[a]
                    .iter()
                    .map(|&a| builder.value(Operation::Ratio(a, num, den)))
                    .collect(),
                VectorOperation::AccelerationsAt(q, v) => {
                    let inputs: Vec<ValueId> = [&vectors[q], &vectors[v], &commands]
                        .into_iter()
                        .flatten()
                        .copied()
                        .collect();
                    builder.inline(equations.accelerations(), &inputs)
                }
            };
            vectors.push(vector);
        }
        let outputs: Vec<ValueId> = vectors[q].iter().chain(&vectors[v]).copied().collect();
        StepProgram { program: builder.finish(&outputs) }
    }

    /// The program from positions, velocities, inputs and the time step to positions and velocities.
    pub fn program(&self) -> &Program {
        &self.program
    }
}
