//! Programs of a single expression.

use super::definitions::{is_name, is_reserved};
use super::equations::{define_parameters, define_values};
use super::program_builder::ProgramBuilder;
use super::resolver::Resolver;
use super::{EquationError, EquationErrorKind, Expression, Program};

impl Program {
    /// The program of an expression of `names`, its inputs in their order, and of parameters with their values; `key` names it in errors.
    ///
    /// # Errors
    /// [`EquationError`]: a parameter with an invalid name or value or one that the expression does not have, or what is wrong with the
    /// expression.
    pub fn of_expression(
        key: &str,
        text: &str,
        names: &[&str],
        parameters: &[(String, f64)],
    ) -> Result<Program, EquationError> {
        let mut taken: Vec<&str> = names.to_vec();
        for (name, value) in parameters {
            let reason = if !is_name(name) {
                Some("no name")
            } else if is_reserved(name) {
                Some("a name of the language")
            } else if taken.contains(&name.as_str()) {
                Some("given twice")
            } else {
                None
            };
            let kind = match reason {
                Some(reason) => EquationErrorKind::Name { name: name.clone(), reason },
                None if !value.is_finite() => {
                    EquationErrorKind::Parameter { name: name.clone(), value: *value }
                }
                None => {
                    taken.push(name);
                    continue;
                }
            };
            return Err(EquationError { key: format!("parameters.{name}"), span: None, kind });
        }
        let expression = Expression::parse(text)
            .map_err(|error| EquationError::of_expression(key.to_owned(), error))?;
        let has = |name: &str| expression.names().any(|(known, _)| known == name);
        if let Some((name, _)) = parameters.iter().find(|(name, _)| !has(name)) {
            let (key, kind) =
                (format!("parameters.{name}"), EquationErrorKind::Unused(name.clone()));
            return Err(EquationError { key, span: None, kind });
        }
        let mut builder = ProgramBuilder::default();
        let inputs = builder.inputs(names.len());
        let mut resolver = Resolver::new(builder);
        define_parameters(&mut resolver, parameters);
        let names: Vec<String> = names.iter().map(|&name| name.to_owned()).collect();
        define_values(&mut resolver, &names, &inputs);
        let output = resolver.evaluate(key, &expression).map_err(|mut error| {
            if let EquationErrorKind::UnknownName { known, .. } = &mut error.kind {
                // Nothing here has a time.
                known.retain(|name| name != "t");
            }
            error
        })?;
        Ok(resolver.builder.finish(&[output]))
    }
}
