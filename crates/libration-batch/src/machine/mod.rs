//! The block machine: straight-line programs on blocks of lanes.
//!
//! A block is a table that stays in the first cache: a row for each value, a column for each lane. [`Lowering`] makes of a
//! [`Program`](libration_equations::Program) a list of instructions on whole rows. What is the same in all lanes, such as a function of the time
//! step, is computed once before. Each instruction is a loop over the lanes of its rows that the compiler makes vectors of, for
//! each instruction set. All operations have the roundings of the program, so that a lane has its bits.

mod block;
mod block_program;
mod instruction;
mod lane;
mod lowering;
mod row_assignment;
mod runs;
mod step;

pub(crate) use block::Block;
pub(crate) use block_program::BlockProgram;
pub(crate) use lane::Lane;
pub(crate) use runs::MachineFloat;
pub(crate) use step::MachineStep;
