//! The loops over lanes of each action.

use core::cell::Cell;

use libration_core::Float;
use libration_equations::Function;

use super::block::{LANES, Lanes};
use super::instruction::{Action, Instruction, Operand};
use crate::ensemble::{InstructionSet, Loop};

/// A float type of the machine.
pub trait MachineFloat: Float {
    /// Executes the runs.
    fn execute(runs: Runs<'_, Self>, set: InstructionSet);
}

// Functions of this crate, so that it alone compiles the loops.
macro_rules! machine_float {
    ($float:ident) => {
        impl MachineFloat for $float {
            fn execute(runs: Runs<'_, Self>, set: InstructionSet) {
                set.vectorize(runs);
            }
        }
    };
}

machine_float!(f32);
machine_float!(f64);

/// Runs of a program on the rows of a block.
pub struct Runs<'a, T> {
    pub(super) instructions: &'a [Instruction],
    pub(super) uniforms: &'a [T],
    pub(super) rows: &'a [Cell<Lanes<T>>],
    /// Groups of lanes in a row.
    pub(super) width: usize,
    pub(super) times: u64,
}

impl<T: Float> Loop for Runs<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        for _ in 0..self.times {
            for instruction in self.instructions {
                self.execute(instruction);
            }
        }
    }
}

/// What an action reads, a group of lanes at a time.
trait Lane<T>: Copy {
    fn group(self, index: usize) -> [T; LANES];
}

/// A row. Each group is read before the result of its lanes is written, so that the result may go into the same row.
#[derive(Clone, Copy)]
struct Row<'a, T>(&'a [Cell<Lanes<T>>]);

impl<T: Copy> Lane<T> for Row<'_, T> {
    #[inline(always)]
    fn group(self, index: usize) -> [T; LANES] {
        self.0[index].get().0
    }
}

/// The same in all lanes.
#[derive(Clone, Copy)]
struct Uniform<T>(T);

impl<T: Copy> Lane<T> for Uniform<T> {
    #[inline(always)]
    fn group(self, _: usize) -> [T; LANES] {
        [self.0; LANES]
    }
}

/// Evaluates `$body` with `$x` as the row or the uniform value that an operand is.
macro_rules! with_lane {
    ($runs:ident, $operand:expr, |$x:ident| $body:expr) => {
        match $operand {
            Operand::Row(row) => {
                let $x = $runs.row(row);
                $body
            }
            Operand::Uniform(u) => {
                let $x = Uniform($runs.uniforms[u]);
                $body
            }
        }
    };
}

impl<'a, T: Float> Runs<'a, T> {
    #[inline(always)]
    fn row(&self, row: usize) -> Row<'a, T> {
        Row(&self.rows[row * self.width..][..self.width])
    }

    #[inline(always)]
    fn execute(&self, instruction: &Instruction) {
        let Instruction { action, operands: [x, y, z, w], to } = *instruction;
        let to = self.row(to);
        match action {
            Action::Copy => with_lane!(self, x, |x| each(to, [x], |[x]| x)),
            Action::Sum => self.of_two(to, x, y, |x, y| x + y),
            Action::Product => self.of_two(to, x, y, |x, y| x * y),
            Action::Difference => self.of_two_in_order(to, x, y, |x, y| x - y),
            Action::Quotient => self.of_two_in_order(to, x, y, |x, y| x.quotient(y)),
            Action::ProductSum => self.of_three(to, [x, y, z], |x, y, z| x * y + z),
            Action::ProductDifference => self.of_three(to, [x, y, z], |x, y, z| x * y - z),
            Action::DifferenceOfProduct => self.of_three(to, [x, y, z], |x, y, z| z - x * y),
            Action::ProductProduct => self.of_three(to, [x, y, z], |x, y, z| x * y * z),
            Action::SumProduct => self.of_three(to, [x, y, z], |x, y, z| (x + y) * z),
            Action::SumSum => self.of_three(to, [x, y, z], |x, y, z| x + y + z),
            Action::Call(function) => self.call(to, function, x, y),
            Action::Choice(or_equal) => {
                let rows = [x, y, z, w].map(|operand| self.row_of(operand));
                match or_equal {
                    true => each(to, rows, |[x, y, z, w]| x.select_less_equal(y, z, w)),
                    false => each(to, rows, |[x, y, z, w]| x.select_less(y, z, w)),
                }
            }
        }
    }

    /// The row that an operand is. Operands that are uniform are given rows where this is called.
    #[inline(always)]
    fn row_of(&self, operand: Operand) -> Row<'a, T> {
        match operand {
            Operand::Row(row) | Operand::Uniform(row) => self.row(row),
        }
    }

    /// Of a row and a row or a uniform value.
    #[inline(always)]
    fn of_two(&self, to: Row<'a, T>, x: Operand, y: Operand, f: impl Fn(T, T) -> T) {
        let x = self.row_of(x);
        with_lane!(self, y, |y| each2(to, x, y, f))
    }

    #[inline(always)]
    fn of_two_in_order(&self, to: Row<'a, T>, x: Operand, y: Operand, f: impl Fn(T, T) -> T) {
        match (x, y) {
            (Operand::Uniform(u), _) => each2(to, Uniform(self.uniforms[u]), self.row_of(y), f),
            (_, _) => self.of_two(to, x, y, f),
        }
    }

    /// Of a row and two rows or uniform values.
    #[inline(always)]
    fn of_three(&self, to: Row<'a, T>, [x, y, z]: [Operand; 3], f: impl Fn(T, T, T) -> T) {
        let x = self.row_of(x);
        with_lane!(self, y, |y| with_lane!(self, z, |z| each3(to, x, y, z, f)))
    }

    #[inline(always)]
    fn call(&self, to: Row<'a, T>, function: Function, x: Operand, y: Operand) {
        let (x, y) = (self.row_of(x), self.row_of(y));
        match function {
            Function::Sin => each(to, [x], |[x]| x.sin()),
            Function::Cos => each(to, [x], |[x]| x.cos()),
            Function::Tan => each(to, [x], |[x]| x.tan()),
            Function::Asin => each(to, [x], |[x]| x.asin()),
            Function::Acos => each(to, [x], |[x]| x.acos()),
            Function::Atan => each(to, [x], |[x]| x.atan()),
            Function::Atan2 => each(to, [x, y], |[x, y]| x.atan2(y)),
            Function::Sinh => each(to, [x], |[x]| x.sinh()),
            Function::Cosh => each(to, [x], |[x]| x.cosh()),
            Function::Tanh => each(to, [x], |[x]| x.tanh()),
            Function::Exp => each(to, [x], |[x]| x.exp()),
            Function::Log => each(to, [x], |[x]| x.ln()),
            Function::Sqrt => each(to, [x], |[x]| x.sqrt()),
            Function::Abs => each(to, [x], |[x]| x.abs()),
            Function::Min => each(to, [x, y], |[x, y]| x.min(y)),
            Function::Max => each(to, [x, y], |[x, y]| x.max(y)),
            Function::Sign => each(to, [x], |[x]| x.signum()),
        }
    }
}

/// Writes a function of the lanes of rows.
#[inline(always)]
fn each<T: Float, L: Lane<T>, const N: usize>(
    to: Row<'_, T>,
    from: [L; N],
    f: impl Fn([T; N]) -> T,
) {
    for (index, to) in to.0.iter().enumerate() {
        let groups = from.map(|x| x.group(index));
        let mut result = [T::zero(); LANES];
        for l in 0..LANES {
            result[l] = f(core::array::from_fn(|i| groups[i][l]));
        }
        to.set(Lanes(result));
    }
}

#[inline(always)]
fn each2<T: Float>(to: Row<'_, T>, x: impl Lane<T>, y: impl Lane<T>, f: impl Fn(T, T) -> T) {
    for (index, to) in to.0.iter().enumerate() {
        let (x, y) = (x.group(index), y.group(index));
        let mut result = [T::zero(); LANES];
        for l in 0..LANES {
            result[l] = f(x[l], y[l]);
        }
        to.set(Lanes(result));
    }
}

#[inline(always)]
fn each3<T: Float>(
    to: Row<'_, T>,
    x: impl Lane<T>,
    y: impl Lane<T>,
    z: impl Lane<T>,
    f: impl Fn(T, T, T) -> T,
) {
    for (index, to) in to.0.iter().enumerate() {
        let (x, y, z) = (x.group(index), y.group(index), z.group(index));
        let mut result = [T::zero(); LANES];
        for l in 0..LANES {
            result[l] = f(x[l], y[l], z[l]);
        }
        to.set(Lanes(result));
    }
}
