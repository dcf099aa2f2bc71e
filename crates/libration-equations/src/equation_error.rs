//! Errors of systems of equations.

use core::ops::Range;

use super::ExpressionError;

/// Error of a system of equations.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{kind}")]
pub struct EquationError {
    /// The definition, as in `acceleration.theta`.
    pub key: String,
    /// The bytes of its text that are wrong; none if the definition itself is.
    pub span: Option<Range<usize>>,
    /// The reason.
    pub kind: EquationErrorKind,
}

impl EquationError {
    /// The error of an expression in a definition.
    pub(crate) fn of_expression(key: String, error: ExpressionError) -> Self {
        let span = Some(error.span.clone());
        EquationError { key, span, kind: EquationErrorKind::Expression(error) }
    }
}

/// The reason of an [`EquationError`].
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EquationErrorKind {
    /// The text is no expression.
    #[error("{0}")]
    Expression(ExpressionError),
    /// A name that nothing has.
    #[error("unknown name `{name}`")]
    UnknownName {
        /// The name with its primes.
        name: String,
        /// All names that exist.
        known: Vec<String>,
    },
    /// Definitions that need each other.
    #[error("`{0}` depends on itself")]
    Circle(String),
    /// A name that is none, or that something else has.
    #[error(
        "`{name}` is {reason}; expected a name of its own, with ASCII letters, digits and `_`, that begins with no digit"
    )]
    Name {
        /// The name.
        name: String,
        /// The reason.
        reason: &'static str,
    },
    /// A coordinate without an acceleration, or an acceleration without a coordinate.
    #[error("`{name}` {reason}")]
    Coordinate {
        /// The coordinate.
        name: String,
        /// The reason.
        reason: &'static str,
    },
    /// Too many or too few states.
    #[error("the system has {0} coordinates and states of first order; expected 1 to {max}", max = crate::MAX_DEGREES)]
    Degrees(usize),
    /// Too many definitions.
    #[error("there are {0} definitions; expected at most {max}", max = crate::MAX_DEFINITIONS)]
    Definitions(usize),
    /// An expression of states that depends on an input.
    #[error(
        "it depends on inputs through `{0}`; expected an expression of states, parameters and time"
    )]
    NeedsInput(String),
    /// An expression without a name that it must have.
    #[error("it does not depend on `{0}`")]
    Independent(&'static str),
    /// A parameter that the expression does not have.
    #[error(
        "the parameter `{0}` has no effect on the expression; expected only parameters that it has"
    )]
    Unused(String),
    /// Too many expressions of a task.
    #[error("there are {0} expressions; expected at most {max}", max = crate::MAX_EXPRESSIONS)]
    Expressions(usize),
    /// A parameter that is no number.
    #[error("the parameter `{name}` is {value}; expected a finite number")]
    Parameter {
        /// The parameter.
        name: String,
        /// Its value.
        value: f64,
    },
}
