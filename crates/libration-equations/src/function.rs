//! Functions of expressions.

use libration_core::Elementary;

/// A function that an expression may call.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Function {
    /// Sine of an angle in rad.
    Sin,
    /// Cosine of an angle in rad.
    Cos,
    /// Tangent of an angle in rad.
    Tan,
    /// Angle in rad with this sine, from −π/2 to π/2.
    Asin,
    /// Angle in rad with this cosine, from 0 to π.
    Acos,
    /// Angle in rad with this tangent, from −π/2 to π/2.
    Atan,
    /// Angle in rad of the point with these `y` and `x`.
    Atan2,
    /// Hyperbolic sine.
    Sinh,
    /// Hyperbolic cosine.
    Cosh,
    /// Hyperbolic tangent.
    Tanh,
    /// Power of e.
    Exp,
    /// Natural logarithm.
    Log,
    /// Square root.
    Sqrt,
    /// Absolute value.
    Abs,
    /// The smaller of two numbers.
    Min,
    /// The larger of two numbers.
    Max,
    /// 1 above zero, −1 below, and 0 of zero.
    Sign,
}

impl Function {
    /// All functions.
    pub const ALL: [Function; 17] = [
        Function::Sin,
        Function::Cos,
        Function::Tan,
        Function::Asin,
        Function::Acos,
        Function::Atan,
        Function::Atan2,
        Function::Sinh,
        Function::Cosh,
        Function::Tanh,
        Function::Exp,
        Function::Log,
        Function::Sqrt,
        Function::Abs,
        Function::Min,
        Function::Max,
        Function::Sign,
    ];

    /// The name in an expression.
    pub const fn name(self) -> &'static str {
        match self {
            Function::Sin => "sin",
            Function::Cos => "cos",
            Function::Tan => "tan",
            Function::Asin => "asin",
            Function::Acos => "acos",
            Function::Atan => "atan",
            Function::Atan2 => "atan2",
            Function::Sinh => "sinh",
            Function::Cosh => "cosh",
            Function::Tanh => "tanh",
            Function::Exp => "exp",
            Function::Log => "log",
            Function::Sqrt => "sqrt",
            Function::Abs => "abs",
            Function::Min => "min",
            Function::Max => "max",
            Function::Sign => "sign",
        }
    }

    /// The number of arguments.
    pub const fn arity(self) -> usize {
        match self {
            Function::Atan2 | Function::Min | Function::Max => 2,
            _ => 1,
        }
    }

    /// Whether the function has a derivative everywhere in its range.
    pub const fn is_smooth(self) -> bool {
        !matches!(self, Function::Abs | Function::Min | Function::Max | Function::Sign)
    }

    /// Whether the function is infinite or NaN for some arguments that are not large.
    pub(crate) const fn is_partial(self) -> bool {
        matches!(
            self,
            Function::Tan
                | Function::Asin
                | Function::Acos
                | Function::Sinh
                | Function::Cosh
                | Function::Exp
                | Function::Log
                | Function::Sqrt
        )
    }

    /// The value of the function. One of a single argument ignores the second.
    pub fn of<S: Elementary>(self, [x, y]: [S; 2]) -> S {
        match self {
            Function::Sin => x.sin(),
            Function::Cos => x.cos(),
            Function::Tan => x.tan(),
            Function::Asin => x.asin(),
            Function::Acos => x.acos(),
            Function::Atan => x.atan(),
            Function::Atan2 => x.atan2(y),
            Function::Sinh => x.sinh(),
            Function::Cosh => x.cosh(),
            Function::Tanh => x.tanh(),
            Function::Exp => x.exp(),
            Function::Log => x.ln(),
            Function::Sqrt => x.sqrt(),
            Function::Abs => x.abs(),
            Function::Min => x.min(y),
            Function::Max => x.max(y),
            Function::Sign => x.signum(),
        }
    }

    /// The function of this name.
    pub fn from_name(name: &str) -> Option<Function> {
        Function::ALL.into_iter().find(|function| function.name() == name)
    }
}
