//! Programs on rows of blocks of environments.

use libration_core::Float;
use libration_equations::Program;

use crate::ensemble::InstructionSet;
use crate::machine::{Block, BlockProgram};
use crate::rl::block_size::LANES;

/// A program for the block machine, with the rows of its inputs and outputs.
#[derive(Debug)]
pub(super) struct RowProgram {
    program: BlockProgram,
    /// The inputs that differ between lanes, each in its row.
    rows: Vec<usize>,
    first_output: usize,
    inputs: usize,
}

impl RowProgram {
    /// A program with `inputs` inputs, of which those in `uniform` are the same in all lanes.
    pub(super) fn new(program: &Program, inputs: usize, uniform: Option<usize>) -> Self {
        let mut rows: Vec<usize> =
            program.inputs_in_use().filter(|&input| Some(input) != uniform).collect();
        rows.sort_unstable();
        rows.dedup();
        let first_output = rows.len();
        let end = first_output + program.outputs().len();
        let targets: Vec<usize> = (first_output..end).collect();
        let row_of = |input: usize| rows.iter().position(|&known| known == input);
        let program = BlockProgram::new(program, row_of, &targets, end);
        RowProgram { program, rows, first_output, inputs }
    }

    /// The number of instructions of a run.
    pub(super) fn instructions(&self) -> usize {
        self.program.instructions()
    }

    /// The rows for `lanes` lanes of a block, with this value of the uniform input.
    pub(super) fn rows<T: Float>(&self, lanes: usize, uniform: T) -> ProgramRows<'_, T> {
        let inputs = vec![uniform; self.inputs];
        ProgramRows { program: self, block: Block::new(&self.program, lanes, &inputs), lanes }
    }
}

impl RowProgram {
    /// Whether the program reads its last input.
    pub(super) fn reads_last(&self) -> bool {
        self.rows.last() == Some(&(self.inputs - 1))
    }
}

/// Rows that a program runs on.
#[derive(Debug)]
pub(super) struct ProgramRows<'p, T> {
    program: &'p RowProgram,
    block: Block<'p, T>,
    lanes: usize,
}

impl<T: Float> ProgramRows<'_, T> {
    /// Runs the program on rows that it replaces by its outputs; `rest` are the inputs after them.
    pub(super) fn run_in_place<'a>(
        &mut self,
        rows: &mut [[T; LANES]],
        rest: impl Fn(usize) -> &'a [T; LANES],
        instructions: InstructionSet,
    ) where
        T: 'a,
    {
        let ProgramRows { program, block, lanes } = self;
        let width = block.lanes();
        for first in (0..*lanes).step_by(width) {
            let lanes = first..(first + width).min(*lanes);
            for (row, &i) in program.rows.iter().enumerate() {
                let values = match i.checked_sub(rows.len()) {
                    None => &rows[i],
                    Some(i) => rest(i),
                };
                block.load(row, &values[lanes.clone()]);
            }
            block.run(1, instructions);
            for (i, to) in rows.iter_mut().enumerate() {
                block.store(program.first_output + i, &mut to[lanes.clone()]);
            }
        }
    }

    /// Runs the program and writes the lanes of its outputs, as many as there are.
    pub(super) fn run<'a>(
        &mut self,
        input: impl Fn(usize) -> &'a [T; LANES],
        to: &mut [[T; LANES]],
        instructions: InstructionSet,
    ) where
        T: 'a,
    {
        let ProgramRows { program, block, lanes } = self;
        let width = block.lanes();
        for first in (0..*lanes).step_by(width) {
            let lanes = first..(first + width).min(*lanes);
            for (row, &i) in program.rows.iter().enumerate() {
                block.load(row, &input(i)[lanes.clone()]);
            }
            block.run(1, instructions);
            for (i, to) in to.iter_mut().enumerate() {
                block.store(program.first_output + i, &mut to[lanes.clone()]);
            }
        }
    }
}
