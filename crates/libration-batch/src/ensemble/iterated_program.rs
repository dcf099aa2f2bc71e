//! Programs that run on their own results.

use libration_equations::Program;

use super::InstructionSet;
use crate::machine::{Block, BlockProgram, MachineFloat};

/// Runs a program `times` times on its own results in each lane: row `i` has input and output `i` of all of them.
pub(super) fn iterate<T: MachineFloat>(
    program: &Program,
    rows: &mut [Vec<T>],
    times: u64,
    set: InstructionSet,
) {
    let count = rows.len();
    let len = rows.iter().map(Vec::len).min().unwrap_or(0);
    let targets: Vec<usize> = (0..count).collect();
    let program = BlockProgram::new(program, |i| (i < count).then_some(i), &targets, count);
    let mut block = Block::new(&program, len, &[]);
    for first in (0..len).step_by(block.lanes()) {
        let lanes = first..(first + block.lanes()).min(len);
        rows.iter().enumerate().for_each(|(i, row)| block.load(i, &row[lanes.clone()]));
        block.run(times, set);
        rows.iter_mut().enumerate().for_each(|(i, row)| block.store(i, &mut row[lanes.clone()]));
    }
}
