//! Functions of expressions.

use libration_core::Elementary;

/// A function that an expression may call.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Function {
    /// Sine of an angle in rad.
    Sin,
    /// Cosine of an angle in rad.
    Cos,
    /// Square root.
    Sqrt,
}

impl Function {
    /// All functions.
    pub const ALL: [Function; 3] = [Function::Sin, Function::Cos, Function::Sqrt];

    /// The name in an expression.
    pub const fn name(self) -> &'static str {
        match self {
            Function::Sin => "sin",
            Function::Cos => "cos",
            Function::Sqrt => "sqrt",
        }
    }

    /// The number of arguments.
    pub const fn arity(self) -> usize {
        1
    }

    /// The value of the function.
    pub fn of<S: Elementary>(self, x: S) -> S {
        match self {
            Function::Sin => x.sin(),
            Function::Cos => x.cos(),
            Function::Sqrt => x.sqrt(),
        }
    }

    /// The function of this name.
    pub fn from_name(name: &str) -> Option<Function> {
        Function::ALL.into_iter().find(|function| function.name() == name)
    }
}
