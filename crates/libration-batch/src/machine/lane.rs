//! One lane: a program on single numbers, of any float type.

use core::ops::{Index, IndexMut};

use libration_core::Float;
use libration_equations::Function;

use super::block_program::BlockProgram;
use super::instruction::{Action, Operand};

/// The length of a short list of numbers, a power of two.
const FEW: usize = 64;

/// The place of the result of the instruction before. It stays in a register: what is stored takes some cycles until it can be loaded,
/// which a chain of operations pays at each link.
const LAST: u32 = u32::MAX;

/// The rows of a program in one lane, followed by its uniform values.
#[derive(Debug)]
pub(crate) struct Lane<S> {
    instructions: Vec<LaneInstruction>,
    numbers: Vec<S>,
    rows: usize,
}

/// An instruction whose operands and result are numbers of one list.
#[derive(Clone, Copy, Debug)]
struct LaneInstruction {
    action: Action,
    operands: [u32; 4],
    to: u32,
}

impl<S: Float> Lane<S> {
    /// A lane of zeros; `inputs` are those of the program, of which only the uniform ones count.
    pub(crate) fn new(program: &BlockProgram, inputs: &[S]) -> Self {
        let rows = program.rows();
        let uniforms = program.uniforms(inputs);
        let mut last = None;
        let instructions = program.instructions.iter().map(|instruction| {
            let place = |operand| match operand {
                Operand::Row(row) if last == Some(row) => LAST,
                Operand::Row(row) => row as u32,
                Operand::Uniform(u) => (rows + u) as u32,
            };
            let operands = instruction.operands.map(place);
            last = Some(instruction.to);
            LaneInstruction { action: instruction.action, operands, to: instruction.to as u32 }
        });
        let instructions = instructions.collect();
        let mut numbers = vec![S::zero(); rows];
        for &(row, uniform) in program.filled() {
            numbers[row] = uniforms[uniform];
        }
        numbers.extend(uniforms);
        numbers.resize(numbers.len().max(FEW), S::zero());
        Lane { instructions, numbers, rows }
    }

    /// The rows.
    pub(crate) fn rows(&self) -> &[S] {
        &self.numbers[..self.rows]
    }

    /// The rows, to be changed.
    pub(crate) fn rows_mut(&mut self) -> &mut [S] {
        &mut self.numbers[..self.rows]
    }

    /// Runs the program `times` times on its own results, or until one of the first `states` rows is not finite. Returns how many runs
    /// ended with finite rows.
    pub(crate) fn run(&mut self, times: u64, states: usize) -> u64 {
        let Lane { instructions, numbers, .. } = self;
        // Places in a list of known length need no checks.
        match <&mut [S; FEW]>::try_from(&mut **numbers) {
            Ok(numbers) => runs(instructions, |place| place % FEW, numbers, times, states),
            Err(_) => runs(instructions, |place| place, &mut **numbers, times, states),
        }
    }
}

/// The list of numbers of a lane: an array or a slice.
trait Numbers<S>: AsRef<[S]> + Index<usize, Output = S> + IndexMut<usize> {}

impl<S, N: AsRef<[S]> + Index<usize, Output = S> + IndexMut<usize> + ?Sized> Numbers<S> for N {}

#[inline(always)]
fn runs<S: Float, N: Numbers<S> + ?Sized>(
    instructions: &[LaneInstruction],
    place: impl Fn(usize) -> usize,
    numbers: &mut N,
    times: u64,
    states: usize,
) -> u64 {
    for done in 0..times {
        let mut last = S::zero();
        for &LaneInstruction { action, operands: [x, y, z, w], to } in instructions {
            let of = |i: u32| if i == LAST { last } else { numbers[place(i as usize)] };
            last = match action {
                Action::Copy => of(x),
                Action::Sum => of(x) + of(y),
                Action::Difference => of(x) - of(y),
                Action::Product => of(x) * of(y),
                Action::Quotient => of(x).quotient(of(y)),
                Action::ProductSum => of(x) * of(y) + of(z),
                Action::ProductDifference => of(x) * of(y) - of(z),
                Action::DifferenceOfProduct => of(z) - of(x) * of(y),
                Action::ProductProduct => of(x) * of(y) * of(z),
                Action::SumProduct => (of(x) + of(y)) * of(z),
                Action::SumSum => of(x) + of(y) + of(z),
                // The functions of most equations; a second choice among all of them takes as long as a sum.
                Action::Call(Function::Sin) => of(x).sin(),
                Action::Call(Function::Cos) => of(x).cos(),
                Action::Call(function) => function.of([of(x), of(y)]),
                Action::Choice(true) => of(x).select_less_equal(of(y), of(z), of(w)),
                Action::Choice(false) => of(x).select_less(of(y), of(z), of(w)),
            };
            numbers[place(to as usize)] = last;
        }
        if !numbers.as_ref()[..states].iter().all(|x| x.is_finite()) {
            return done;
        }
    }
    times
}
