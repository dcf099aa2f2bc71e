//! Errors of expressions in files: where they are, and what would help.

use std::ops::Range;

use libration::equations::{EquationError, EquationErrorKind, ExpressionErrorKind, Function};
use toml::Spanned;

use crate::suggestions;

/// The place in the file of an error within an expression; none if the whole definition is wrong.
pub(crate) fn inside(
    value: &Spanned<String>,
    error: &EquationError,
    text: &str,
) -> Option<Range<usize>> {
    let inside = error.span.clone()?;
    // An escape is longer in the file than in the expression.
    let begin = value.span().start + text.get(value.span())?.find(value.get_ref().as_str())?;
    Some(begin + inside.start..begin + inside.end)
}

/// A suggestion for a name that does not exist.
pub(crate) fn help(error: &EquationError) -> Option<String> {
    match &error.kind {
        EquationErrorKind::UnknownName { name, known } => {
            Some(suggestions::suggest("names", name, known.iter().map(String::as_str)))
        }
        EquationErrorKind::Expression(error) => match &error.kind {
            ExpressionErrorKind::UnknownFunction { name } => {
                let functions = Function::ALL.map(Function::name);
                let near = suggestions::nearest(name, functions)?;
                Some(format!("did you mean `{near}`?"))
            }
            _ => None,
        },
        _ => None,
    }
}

/// The error in one line, with its key and a suggestion, for an expression that stands in no file.
pub fn explanation(error: &EquationError) -> String {
    let help = help(error).map_or_else(String::new, |help| format!("; {help}"));
    format!("{}: {error}{help}", error.key)
}
