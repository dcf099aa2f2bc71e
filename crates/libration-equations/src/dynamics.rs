//! Accelerations of a system as a program.

use libration_core::system::CommandedSystem;
use libration_core::{Hamiltonian, Model, Scalar, State, System};

use super::program::{Operation, Program, ValueId};
use super::program_builder::ProgramBuilder;
use super::recording::Recorded;

/// The accelerations `a(q, v, u)` of a system whose number of degrees of freedom is known when the program runs.
#[derive(Clone, Debug, PartialEq)]
pub struct Dynamics {
    degrees: usize,
    inputs: usize,
    accelerations: Program,
    energy: Option<Program>,
}

impl Dynamics {
    /// Programs from `degrees` positions, as many velocities and `inputs` inputs to accelerations, and to the energy where there is
    /// one.
    pub(crate) fn new(
        degrees: usize,
        inputs: usize,
        accelerations: Program,
        energy: Option<Program>,
    ) -> Self {
        Dynamics { degrees, inputs, accelerations, energy }
    }

    /// A compiled system, recorded: on each number type it has the bits of the system. With a mobility its inputs are commands, one
    /// in each degree of freedom, and mobility times command is added to its acceleration.
    pub fn of<const D: usize>(model: &impl Model<D>, mobility: Option<f64>) -> Self {
        // The system is made within each recording, since its parameters are constants of the program.
        let state = |x: &[Recorded]| State {
            q: core::array::from_fn::<_, D, _>(|i| x[i]),
            v: core::array::from_fn(|i| x[D + i]),
        };
        let inputs = if mobility.is_some() { D } else { 0 };
        let accelerations = Program::record(2 * D + inputs, |x| {
            let system = model.on::<Recorded>();
            let accelerations = match mobility {
                Some(mobility) => {
                    let accelerated = |command| match mobility {
                        1.0 => command,
                        mobility => command * Recorded::from_f64(mobility),
                    };
                    let command = core::array::from_fn(|i| accelerated(x[2 * D + i]));
                    CommandedSystem { system, command }.acceleration(&state(x))
                }
                None => system.acceleration(&state(x)),
            };
            accelerations.to_vec()
        });
        let energy = Program::record(2 * D, |x| vec![model.on::<Recorded>().energy(&state(x))]);
        Dynamics::new(D, inputs, accelerations, Some(energy))
    }

    /// The same with an input for each degree of freedom: an acceleration added to its own.
    pub fn with_added_accelerations(&self) -> Self {
        let mut builder = ProgramBuilder::literal();
        let count = 2 * self.degrees + self.inputs;
        let (known, added) = (builder.inputs(count), builder.inputs(self.degrees));
        let own = builder.inline(&self.accelerations, &known);
        let sum = |(&own, &added): (&ValueId, &ValueId)| builder.value(Operation::Sum(own, added));
        let sums: Vec<ValueId> = own.iter().zip(&added).map(sum).collect();
        let accelerations = builder.finish(&sums);
        let inputs = self.inputs + self.degrees;
        Dynamics { inputs, accelerations, ..self.clone() }
    }

    /// Degrees of freedom.
    pub fn degrees(&self) -> usize {
        self.degrees
    }

    /// The number of inputs.
    pub fn inputs(&self) -> usize {
        self.inputs
    }

    /// The program from positions, velocities and inputs to accelerations.
    pub fn accelerations(&self) -> &Program {
        &self.accelerations
    }

    /// The program from positions, velocities and inputs to the energy, if there is one.
    pub fn energy(&self) -> Option<&Program> {
        self.energy.as_ref()
    }

    /// Whether no acceleration depends on a velocity.
    pub fn is_positional(&self) -> bool {
        let velocities = self.degrees..2 * self.degrees;
        !self.accelerations.inputs_in_use().any(|input| velocities.contains(&input))
    }
}
