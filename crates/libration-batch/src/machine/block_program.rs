//! Programs for blocks.

use libration_core::Float;
use libration_equations::Program;

use super::instruction::Instruction;
use super::lowering::{Lowering, Uniform};
use super::row_assignment::RowAssignment;

/// Instructions of a step of symplectic Euler on an oscillator.
const SHORTEST: u64 = 3;

/// A program as instructions on the rows of a block.
#[derive(Debug)]
pub(crate) struct BlockProgram {
    /// The values of the program that are the same in all lanes.
    values: Program,
    uniforms: Vec<UniformValue>,
    /// Rows that hold a uniform value from the start.
    filled: Vec<(usize, usize)>,
    pub(super) instructions: Vec<Instruction>,
    rows: usize,
}

/// A uniform value: an output of `values`, its negative, or a constant.
#[derive(Clone, Copy, Debug)]
enum UniformValue {
    Output { index: usize, is_negative: bool },
    Constant(f64),
}

impl BlockProgram {
    /// A program whose inputs `i` with a row begin in it, whose other inputs are the same in all lanes, and whose output `i` ends in row
    /// `targets[i]`. All these rows are below `interface`.
    pub(crate) fn new(
        program: &Program,
        row_of_input: impl Fn(usize) -> Option<usize>,
        targets: &[usize],
        interface: usize,
    ) -> Self {
        let (lowering, outputs) = Lowering::new(program, row_of_input);
        let RowAssignment { filled, instructions, rows } =
            RowAssignment::new(&lowering, &outputs, targets, interface);
        let mut needed = Vec::new();
        let mut output = |id| {
            let known = needed.iter().position(|&other| other == id);
            known.unwrap_or_else(|| {
                needed.push(id);
                needed.len() - 1
            })
        };
        let uniforms = lowering.uniforms.iter().map(|uniform| match *uniform {
            Uniform::Value(id) => UniformValue::Output { index: output(id), is_negative: false },
            Uniform::Negative(id) => UniformValue::Output { index: output(id), is_negative: true },
            Uniform::Constant(c) => UniformValue::Constant(c),
        });
        let uniforms = uniforms.collect();
        BlockProgram { values: program.part(&needed), uniforms, filled, instructions, rows }
    }

    /// The number of rows.
    pub(crate) fn rows(&self) -> usize {
        self.rows
    }

    /// The length of a run: the number of steps of symplectic Euler on an oscillator, the shortest there are, that take as long.
    pub(crate) fn shortest_steps(&self) -> u64 {
        (self.instructions.len() as u64).div_ceil(SHORTEST)
    }

    /// The uniform values for these inputs of the program, of which only the uniform ones count.
    pub(super) fn uniforms<T: Float>(&self, inputs: &[T]) -> Vec<T> {
        let values: Vec<T> = self.values.on::<T>().run(inputs).collect();
        let of = |uniform: &UniformValue| match *uniform {
            UniformValue::Output { index, is_negative: false } => values[index],
            UniformValue::Output { index, is_negative: true } => -values[index],
            UniformValue::Constant(c) => T::from_f64(c),
        };
        self.uniforms.iter().map(of).collect()
    }

    /// Rows and the uniform values that they hold from the start.
    pub(super) fn filled(&self) -> &[(usize, usize)] {
        &self.filled
    }
}
