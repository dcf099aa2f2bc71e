//! Steps of integrators as programs.

use libration_core::integrator::ImplicitIntegrator;
use libration_core::thermostat::LangevinMethod;
use libration_core::{AnyMethod, Integrator};

use super::Dynamics;
use super::derivative_programs::DerivativePrograms;
use super::program::{Operation, Program, ValueId};
use super::program_builder::ProgramBuilder;
use super::step_trace::{StageOperands, VectorId, VectorOperation};
use super::vector_step::VectorStep;

/// One step of an integrator on a system.
#[derive(Clone, Debug, PartialEq)]
pub struct StepProgram {
    program: Program,
    evaluations: usize,
}

impl StepProgram {
    /// The most degrees of freedom for which a step is a program of moderate size, less than a million operations: 32 for
    /// [implicit](StepProgram::implicit) steps, divided by the stages whose equations they solve together. Explicit steps have no limit.
    pub fn most_degrees(method: impl Into<AnyMethod>) -> usize {
        match method.into() {
            AnyMethod::Explicit(_) => usize::MAX,
            AnyMethod::Implicit(method) => 32 / method.coupled_stages(),
        }
    }

    /// A step of `integrator` on a system, whose inputs are constant during the step: from positions, velocities, inputs and the
    /// time step to positions and velocities.
    pub fn new(integrator: impl Integrator, dynamics: &Dynamics) -> Self {
        StepProgram::of_vectors(&VectorStep::new(integrator, None), Shape::default(), dynamics)
    }

    /// The same of an integrator that solves equations, by [elimination](libration_core::elimination) with derivatives by dual numbers:
    /// it has the bits of the integrator on the system [differentiated](libration_core::system::Differentiated).
    ///
    /// The program grows with the cube of the degrees of freedom, and each Newton step is written out.
    pub fn implicit(integrator: impl ImplicitIntegrator, dynamics: &Dynamics) -> Self {
        StepProgram::of_vectors(&VectorStep::implicit(integrator), Shape::default(), dynamics)
    }

    /// A step that takes the accelerations at its start and hands on those at its end, which saves an evaluation: from positions,
    /// velocities, accelerations, inputs and the time step to positions, velocities and accelerations.
    ///
    /// None if the integrator [carries](Integrator::CARRIES) nothing or an acceleration depends on a velocity.
    pub fn carrying<M: Integrator>(integrator: M, dynamics: &Dynamics) -> Option<Self> {
        let step = VectorStep::carrying(integrator, None).filter(|_| dynamics.is_positional())?;
        let shape = Shape { carries: true, ..Shape::default() };
        Some(StepProgram::of_vectors(&step, shape, dynamics))
    }

    /// A step of Langevin dynamics that takes the accelerations at its start and hands on those at its end: from positions, velocities,
    /// accelerations, inputs, the time step, the other numbers of a [`LangevinStep`](libration_core::thermostat::LangevinStep) in their
    /// order, and the [vectors of noise](LangevinMethod::noises) to positions, velocities and accelerations.
    ///
    /// None if an acceleration depends on a velocity.
    pub fn langevin(method: &LangevinMethod, dynamics: &Dynamics) -> Option<Self> {
        if !dynamics.is_positional() {
            return None;
        }
        let shape = Shape { carries: true, numbers: 3, noises: method.noises() };
        Some(StepProgram::of_vectors(&VectorStep::langevin(method), shape, dynamics))
    }

    /// A step of a built-in integrator.
    pub fn of(method: impl Into<AnyMethod>, dynamics: &Dynamics) -> Self {
        match method.into() {
            AnyMethod::Explicit(method) => StepProgram::new(method, dynamics),
            AnyMethod::Implicit(method) => StepProgram::implicit(method, dynamics),
        }
    }

    fn of_vectors(step: &VectorStep, shape: Shape, dynamics: &Dynamics) -> Self {
        let evaluations = step.operations().iter().map(|operation| match operation {
            VectorOperation::AccelerationsAt(..) | VectorOperation::AccelerationDerivative(_) => 1,
            VectorOperation::Solution(..) => dynamics.degrees(),
            // Along each position and each velocity of each stage.
            VectorOperation::StageSolutions(operands) => 2 * dynamics.degrees() * operands.at.len(),
            _ => 0,
        });
        StepProgram { evaluations: evaluations.sum(), program: program(step, shape, dynamics) }
    }

    /// Evaluations of the accelerations in a step, those along a direction of a derivative included.
    pub fn evaluations(&self) -> usize {
        self.evaluations
    }

    /// The program.
    pub fn program(&self) -> &Program {
        &self.program
    }
}

/// The inputs of a program of a step besides positions, velocities, the inputs of the system and the time step.
#[derive(Clone, Copy, Debug, Default)]
struct Shape {
    /// Whether it takes accelerations.
    carries: bool,
    /// The count of [numbers](VectorOperation::Number).
    numbers: usize,
    /// The count of vectors of [noise](VectorOperation::Noise).
    noises: usize,
}

/// The program of recorded operations on vectors.
fn program(
    step: &VectorStep,
    Shape { carries, numbers, noises }: Shape,
    dynamics: &Dynamics,
) -> Program {
    let degrees = dynamics.degrees();
    let mut builder = ProgramBuilder::literal();
    let (positions, velocities) = (builder.inputs(degrees), builder.inputs(degrees));
    let known = builder.inputs(if carries { degrees } else { 0 });
    let commands = builder.inputs(dynamics.inputs());
    let dt = builder.input();
    let numbers = builder.inputs(numbers);
    let noises = builder.inputs(noises * degrees);
    let mut derivatives = DerivativePrograms::new(dynamics);
    let mut vectors: Vec<Vec<ValueId>> = Vec::with_capacity(step.operations().len());
    for operation in step.operations() {
        let of_two = |builder: &mut ProgramBuilder,
                      a: VectorId,
                      b: VectorId,
                      operation: fn(ValueId, ValueId) -> Operation| {
            let pairs = vectors[a].iter().zip(&vectors[b]);
            pairs.map(|(&a, &b)| builder.value(operation(a, b))).collect()
        };
        let vector = match *operation {
            VectorOperation::Positions => positions.clone(),
            VectorOperation::Velocities => velocities.clone(),
            VectorOperation::Accelerations => known.clone(),
            VectorOperation::TimeStep => vec![dt; degrees],
            VectorOperation::Number(i) => vec![numbers[i]; degrees],
            VectorOperation::Noise(i) => noises[i * degrees..(i + 1) * degrees].to_vec(),
            VectorOperation::Constant(c) => vec![builder.constant(c); degrees],
            VectorOperation::Sum(a, b) => of_two(&mut builder, a, b, Operation::Sum),
            VectorOperation::Difference(a, b) => of_two(&mut builder, a, b, Operation::Difference),
            VectorOperation::Product(a, b) => of_two(&mut builder, a, b, Operation::Product),
            VectorOperation::Negative(a) => {
                vectors[a].iter().map(|&a| builder.value(Operation::Negative(a))).collect()
            }
            VectorOperation::Ratio(a, num, den) => {
                vectors[a].iter().map(|&a| builder.value(Operation::Ratio(a, num, den))).collect()
            }
            VectorOperation::AccelerationsAt(q, v) => {
                let inputs = [&vectors[q], &vectors[v], &commands];
                let inputs: Vec<ValueId> = inputs.into_iter().flatten().copied().collect();
                builder.inline(dynamics.accelerations(), &inputs)
            }
            VectorOperation::AccelerationDerivative(operands) => {
                let [q, v, along_q, along_v] = operands.map(|operand| &vectors[operand]);
                let inputs = [q, v, &commands, along_q, along_v];
                let inputs: Vec<ValueId> = inputs.into_iter().flatten().copied().collect();
                builder.inline(derivatives.along_a_direction(), &inputs)
            }
            VectorOperation::Solution(implicit, operands) => {
                let [q, v, h, right] = operands.map(|operand| &vectors[operand]);
                // The time step is the same in each entry.
                let inputs = [q, v, &commands, &h[..1], right];
                let inputs: Vec<ValueId> = inputs.into_iter().flatten().copied().collect();
                builder.inline(derivatives.solution(implicit), &inputs)
            }
            VectorOperation::StageSolutions(ref operands) => {
                let StageOperands { at, of_q, of_v, right } = operands;
                let whole = |ids: &[VectorId]| -> Vec<ValueId> {
                    ids.iter().flat_map(|&id| &vectors[id]).copied().collect()
                };
                let coefficients = of_q.iter().chain(of_v).map(|&id| vectors[id][0]);
                let mut inputs = whole(at.as_flattened());
                inputs.extend(&commands);
                inputs.extend(coefficients);
                inputs.extend(whole(right));
                builder.inline(derivatives.stage_solutions(at.len()), &inputs)
            }
            VectorOperation::StageSolution(all, i) => {
                vectors[all][i * degrees..(i + 1) * degrees].to_vec()
            }
        };
        vectors.push(vector);
    }
    let outputs: Vec<ValueId> = step.ends().iter().flat_map(|&end| vectors[end].clone()).collect();
    builder.finish(&outputs)
}
