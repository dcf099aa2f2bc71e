//! A number that records what is done with it.

use core::cell::RefCell;
use core::ops::{Add, Mul, Neg, Sub};

use libration_core::{Elementary, Scalar};

use super::Function;
use super::program::{Operation, Program, ValueId};
use super::program_builder::ProgramBuilder;

thread_local! {
    /// The program that is being recorded on this thread.
    static BUILDER: RefCell<Option<ProgramBuilder>> = const { RefCell::new(None) };
}

/// A number within [`Program::record`]: an operation on it becomes an operation of the program.
///
/// Outside, operations on it have no effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Recorded(ValueId);

impl Program {
    /// The program of a function of so many inputs.
    ///
    /// All operations are recorded, those of constants too, so that on any number type the program has the bits of the function.
    pub fn record(inputs: usize, function: impl FnOnce(&[Recorded]) -> Vec<Recorded>) -> Program {
        let outer = BUILDER.replace(Some(ProgramBuilder::literal()));
        let inputs: Vec<Recorded> =
            (0..inputs).map(|_| record(|builder| builder.input())).collect();
        let outputs: Vec<ValueId> = function(&inputs).into_iter().map(|Recorded(id)| id).collect();
        BUILDER.replace(outer).unwrap_or_default().finish(&outputs)
    }
}

fn record(operation: impl FnOnce(&mut ProgramBuilder) -> ValueId) -> Recorded {
    BUILDER.with_borrow_mut(|builder| Recorded(builder.as_mut().map_or(0, operation)))
}

fn value(operation: Operation) -> Recorded {
    record(|builder| builder.value(operation))
}

impl Add for Recorded {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        value(Operation::Sum(self.0, other.0))
    }
}

impl Sub for Recorded {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        value(Operation::Difference(self.0, other.0))
    }
}

impl Mul for Recorded {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        value(Operation::Product(self.0, other.0))
    }
}

impl Neg for Recorded {
    type Output = Self;
    fn neg(self) -> Self {
        value(Operation::Negative(self.0))
    }
}

impl Scalar for Recorded {
    fn from_f64(c: f64) -> Self {
        value(Operation::Constant(c))
    }

    fn ratio(self, num: i32, den: i32) -> Self {
        value(Operation::Ratio(self.0, num, den))
    }
}

fn call(function: Function, operands: [Recorded; 2]) -> Recorded {
    value(Operation::Call(function, operands.map(|Recorded(id)| id)))
}

macro_rules! calls {
    ($($name:ident($($other:ident)?): $function:ident,)*) => {$(
        fn $name(self $(, $other: Self)?) -> Self {
            // A function of one argument is recorded with it twice.
            let operands = [self, self];
            call(Function::$function, calls!(@ operands $($other)?))
        }
    )*};
    (@ $operands:ident $other:ident) => { [$operands[0], $other] };
    (@ $operands:ident) => { $operands };
}

impl Elementary for Recorded {
    calls! {
        sqrt(): Sqrt,
        sin(): Sin,
        cos(): Cos,
        tan(): Tan,
        asin(): Asin,
        acos(): Acos,
        atan(): Atan,
        atan2(x): Atan2,
        exp(): Exp,
        ln(): Log,
        sinh(): Sinh,
        cosh(): Cosh,
        tanh(): Tanh,
        abs(): Abs,
        min(other): Min,
        max(other): Max,
        signum(): Sign,
    }

    fn recip(self) -> Self {
        value(Operation::Reciprocal(self.0))
    }

    fn quotient(self, divisor: Self) -> Self {
        value(Operation::Quotient(self.0, divisor.0))
    }

    fn select_less(self, other: Self, then: Self, otherwise: Self) -> Self {
        value(Operation::Choice(false, [self, other, then, otherwise].map(|Recorded(id)| id)))
    }

    fn select_less_equal(self, other: Self, then: Self, otherwise: Self) -> Self {
        value(Operation::Choice(true, [self, other, then, otherwise].map(|Recorded(id)| id)))
    }

    /// Two numbers are equal if neither is less and one is not greater.
    fn select_equal(self, other: Self, then: Self, otherwise: Self) -> Self {
        let not_less = self.select_less(other, otherwise, then);
        self.select_less_equal(other, not_less, otherwise)
    }
}
