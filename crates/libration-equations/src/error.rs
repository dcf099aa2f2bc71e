//! Errors of expressions.

use core::ops::Range;

use super::Function;

/// Error of an expression, with its place in the text.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{kind}")]
pub struct ExpressionError {
    /// The bytes of the text that are wrong.
    pub span: Range<usize>,
    /// The reason.
    pub kind: ExpressionErrorKind,
}

/// The reason of an [`ExpressionError`].
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ExpressionErrorKind {
    /// Text that does not belong there.
    #[error("found {found}; expected {expected}")]
    Unexpected {
        /// The text, between backquotes, or the end.
        found: String,
        /// The allowed texts.
        expected: &'static str,
    },
    /// A number that no float holds.
    #[error("the number `{0}` is too large; expected at most 1.797e308 in size")]
    Number(String),
    /// A function that does not exist.
    #[error("unknown function `{name}`; the functions are {}", functions())]
    UnknownFunction {
        /// The name.
        name: String,
    },
    /// Another number of arguments.
    #[error("`{name}` has {given} arguments; expected {expected}")]
    Arguments {
        /// The function.
        name: &'static str,
        /// The number of arguments.
        given: usize,
        /// The allowed number.
        expected: usize,
    },
    /// More primes than a derivative may have.
    #[error("`{name}` has {primes} primes; expected at most 2, as in x'' for an acceleration")]
    Primes {
        /// The name.
        name: String,
        /// The number of primes.
        primes: usize,
    },
    /// Brackets, signs or powers within each other.
    #[error("brackets, functions or powers are nested too deep; expected at most {0} levels")]
    Depth(usize),
    /// An expression with too much text.
    #[error("the expression has {0} bytes; expected at most {max}", max = crate::MAX_LENGTH)]
    Length(usize),
}

fn functions() -> String {
    let names = Function::ALL.map(|function| format!("`{}`", function.name()));
    format!("{} and `if`", names.join(", "))
}
