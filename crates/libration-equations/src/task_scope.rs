//! Names and expressions of tasks.

use super::equations::{define_parameters, define_states, define_values};
use super::program::ValueId;
use super::program_builder::ProgramBuilder;
use super::resolver::Resolver;
use super::{
    Definitions, EquationError, EquationErrorKind, Equations, Expression, ExpressionError,
};

/// The names of a system with these states and parameters that vary.
pub(super) fn scope(
    builder: ProgramBuilder,
    definitions: &Definitions,
    equations: &Equations,
    (state, varied): (&[ValueId], &[ValueId]),
) -> Result<Resolver, EquationError> {
    let mut resolver = Resolver::new(builder);
    define_parameters(&mut resolver, &definitions.parameters);
    define_values(&mut resolver, &definitions.varied, varied);
    let degrees = equations.degrees();
    define_states(&mut resolver, degrees, state.split_at(degrees.len()), str::to_owned);
    for own in definitions.parse()? {
        resolver.define_expression(own);
    }
    Ok(resolver)
}

/// Gives a name of the key its value, unless the system has such a name.
pub(super) fn define_new(
    resolver: &mut Resolver,
    name: &str,
    value: ValueId,
    key: &str,
) -> Result<(), EquationError> {
    if resolver.defines(name) {
        let reason = "a name of this key";
        let kind = EquationErrorKind::Name { name: name.into(), reason };
        return Err(EquationError { key: key.to_owned(), span: None, kind });
    }
    resolver.define(name, 0, value);
    Ok(())
}

/// The value of a text.
pub(super) fn value(
    resolver: &mut Resolver,
    key: &str,
    text: &str,
    parse: fn(&str) -> Result<Expression, ExpressionError>,
) -> Result<ValueId, EquationError> {
    let expression =
        parse(text).map_err(|error| EquationError::of_expression(key.to_owned(), error))?;
    resolver.evaluate(key, &expression).map_err(|error| match error.key == key {
        true => error,
        // The definitions of the system are right, but for inputs that are no names here.
        false => {
            let kind = EquationErrorKind::NeedsInput(error.key);
            EquationError { key: key.to_owned(), span: None, kind }
        }
    })
}
