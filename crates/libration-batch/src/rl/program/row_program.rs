//! Programs on rows of blocks of environments.

use core::ops::Range;
use std::sync::Arc;

use libration_equations::{Operation, Program};

use crate::ensemble::InstructionSet;
use crate::machine::{Block, BlockProgram, MachineFloat};
use crate::rl::block_size::LANES;

/// A program for the block machine, with the rows of its inputs and outputs.
#[derive(Clone, Debug)]
pub(super) struct RowProgram {
    program: Arc<BlockProgram>,
    /// The inputs that differ between lanes, each in its row.
    rows: Arc<[usize]>,
    first_output: usize,
    inputs: usize,
    /// The inputs that the outputs are, if nothing is computed.
    copied: Option<Arc<[usize]>>,
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
        let copied = program.outputs().iter().map(|&id| match program.values()[id] {
            Operation::Input(input) => Some(input),
            _ => None,
        });
        let copied = copied.collect();
        let row_of = |input: usize| rows.iter().position(|&known| known == input);
        let program = BlockProgram::new(program, row_of, &targets, end);
        RowProgram { program: Arc::new(program), rows: rows.into(), first_output, inputs, copied }
    }

    /// See [`BlockProgram::shortest_steps`].
    pub(super) fn shortest_steps(&self) -> u64 {
        self.program.shortest_steps()
    }

    /// The rows for `lanes` lanes of a block, with this value of the uniform input.
    pub(super) fn rows<T: MachineFloat>(&self, lanes: usize, uniform: T) -> ProgramRows<T> {
        let inputs = vec![uniform; self.inputs];
        let block = Block::new(Arc::clone(&self.program), lanes, &inputs);
        ProgramRows { program: self.clone(), block, lanes }
    }
}

impl RowProgram {
    /// Whether the program reads its last input.
    pub(super) fn reads_last(&self) -> bool {
        self.rows.last() == Some(&(self.inputs - 1))
    }

    /// Whether the program reads one of its first inputs, so many.
    pub(super) fn reads_first(&self, count: usize) -> bool {
        self.rows.first().is_some_and(|&first| first < count)
    }
}

/// Rows that a program runs on.
#[derive(Debug)]
pub(super) struct ProgramRows<T> {
    program: RowProgram,
    block: Block<Arc<BlockProgram>, T>,
    lanes: usize,
}

impl<T: MachineFloat> ProgramRows<T> {
    /// See [`RowProgram::reads_last`].
    pub(super) fn reads_last(&self) -> bool {
        self.program.reads_last()
    }

    /// See [`RowProgram::reads_first`].
    pub(super) fn reads_first(&self, count: usize) -> bool {
        self.program.reads_first(count)
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
        if let Some(copied) = &self.program.copied {
            for (to, &i) in to.iter_mut().zip(&**copied) {
                to[..self.lanes].copy_from_slice(&input(i)[..self.lanes]);
            }
            return;
        }
        for lanes in self.strips() {
            self.load(&lanes, &input);
            self.finish(&lanes, to, instructions);
        }
    }

    /// Runs the program on rows that it replaces by its outputs; `rest` are the inputs after them.
    pub(super) fn run_in_place<'a>(
        &mut self,
        rows: &mut [[T; LANES]],
        rest: impl Fn(usize) -> &'a [T; LANES],
        instructions: InstructionSet,
    ) where
        T: 'a,
    {
        for lanes in self.strips() {
            self.load(&lanes, |i| rows.get(i).unwrap_or_else(|| rest(i - rows.len())));
            self.finish(&lanes, rows, instructions);
        }
    }

    /// Ranges of lanes that are run together.
    fn strips(&self) -> impl Iterator<Item = Range<usize>> + use<T> {
        let (lanes, width) = (self.lanes, self.block.lanes());
        (0..lanes).step_by(width).map(move |first| first..(first + width).min(lanes))
    }

    fn load<'b>(&mut self, lanes: &Range<usize>, input: impl Fn(usize) -> &'b [T; LANES])
    where
        T: 'b,
    {
        for (row, &i) in self.program.rows.iter().enumerate() {
            self.block.load(row, &input(i)[lanes.clone()]);
        }
    }

    fn finish(&mut self, lanes: &Range<usize>, to: &mut [[T; LANES]], set: InstructionSet) {
        self.block.run(1, set);
        for (i, to) in to.iter_mut().enumerate() {
            self.block.store(self.program.first_output + i, &mut to[lanes.clone()]);
        }
    }
}
