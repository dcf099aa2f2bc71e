//! Instructions on rows.

use libration_equations::Function;

/// A row, or the index of a number that is the same in all lanes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Operand {
    Row(usize),
    Uniform(usize),
}

/// What an instruction computes of its operands `x, y, z, w`, with a rounding for each operation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Action {
    /// `x`
    Copy,
    /// `x + y`
    Sum,
    /// `x − y`
    Difference,
    /// `x·y`
    Product,
    /// `x/y`
    Quotient,
    /// `x·y + z`
    ProductSum,
    /// `x·y − z`
    ProductDifference,
    /// `z − x·y`
    DifferenceOfProduct,
    /// `(x·y)·z`
    ProductProduct,
    /// `(x + y)·z`
    SumProduct,
    /// `(x + y) + z`
    SumSum,
    /// `f(x)` or `f(x, y)`
    Call(Function),
    /// `z` if `x < y`, else `w`; if equal as the flag says.
    Choice(bool),
}

impl Action {
    /// The number of operands.
    pub(super) fn arity(self) -> usize {
        match self {
            Action::Copy => 1,
            Action::Sum | Action::Difference | Action::Product | Action::Quotient => 2,
            Action::ProductSum
            | Action::ProductDifference
            | Action::DifferenceOfProduct
            | Action::ProductProduct
            | Action::SumProduct
            | Action::SumSum => 3,
            Action::Call(function) => function.arity(),
            Action::Choice(_) => 4,
        }
    }

    /// Whether all operands must be rows.
    pub(super) fn needs_rows(self) -> bool {
        matches!(self, Action::Call(_) | Action::Choice(_))
    }
}

/// An instruction. The row that it writes may be one that it reads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Instruction {
    pub(super) action: Action,
    /// As many as the action has; the others repeat the first.
    pub(super) operands: [Operand; 4],
    /// The row of the result.
    pub(super) to: usize,
}
