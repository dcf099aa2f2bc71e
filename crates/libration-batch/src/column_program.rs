//! Programs on columns of numbers.

use libration_equations::Program;

use crate::ensemble::InstructionSet;
use crate::machine::{Block, BlockProgram};

/// A program that runs on columns: one evaluation for each place.
#[derive(Debug)]
pub struct ColumnProgram {
    program: BlockProgram,
    inputs: Vec<usize>,
    outputs: usize,
}

/// A [`ColumnProgram`] with the memory that it needs.
#[derive(Debug)]
pub struct Columns<'p> {
    program: &'p ColumnProgram,
    block: Block<&'p BlockProgram, f64>,
}

impl ColumnProgram {
    /// The program for columns.
    pub fn new(program: &Program) -> Self {
        let mut inputs: Vec<usize> = program.inputs_in_use().collect();
        inputs.sort_unstable();
        inputs.dedup();
        let outputs = program.outputs().len();
        let end = inputs.len() + outputs;
        let targets: Vec<usize> = (inputs.len()..end).collect();
        let row_of = |input: usize| inputs.iter().position(|&known| known == input);
        let program = BlockProgram::new(program, row_of, &targets, end);
        ColumnProgram { program, inputs, outputs }
    }

    /// Steps of the shortest of an [`Execution`](crate::ensemble::Execution) that take as long as one evaluation.
    pub fn shortest_steps(&self) -> u64 {
        self.program.shortest_steps()
    }

    /// Memory for columns of at most `length` numbers.
    pub fn columns(&self, length: usize) -> Columns<'_> {
        Columns { program: self, block: Block::new(&self.program, length, &[]) }
    }
}

impl Columns<'_> {
    /// Evaluates the program at each place of the inputs, of which those in use have the length of the outputs. The bits are those of a
    /// single evaluation, for every instruction set.
    pub fn run<'a>(
        &mut self,
        input: impl Fn(usize) -> &'a [f64],
        outputs: &mut [&mut [f64]],
        set: InstructionSet,
    ) {
        let length = outputs.iter().map(|column| column.len()).min().unwrap_or(0);
        let (inputs, first_output) = (&self.program.inputs, self.program.inputs.len());
        for first in (0..length).step_by(self.block.lanes()) {
            let places = first..(first + self.block.lanes()).min(length);
            for (row, &i) in inputs.iter().enumerate() {
                self.block.load(row, &input(i)[places.clone()]);
            }
            self.block.run(1, set);
            for (i, column) in outputs.iter_mut().take(self.program.outputs).enumerate() {
                self.block.store(first_output + i, &mut column[places.clone()]);
            }
        }
    }
}
