//! Names in equations, and what they stand for.

use core::ops::Range;
use std::collections::HashMap;

use super::definitions::{ENERGY, NamedExpression};
use super::expression::{Comparison, Expression, NodeKind, Operator};
use super::program::{Operation, ValueId};
use super::program_builder::ProgramBuilder;
use super::{EquationError, EquationErrorKind, Function};

/// The values of names, computed where they are needed first.
pub(crate) struct Resolver {
    pub(crate) builder: ProgramBuilder,
    meanings: HashMap<Name, Meaning>,
}

/// A name with the number of its primes.
type Name = (String, usize);

/// What a name stands for.
enum Meaning {
    Value(ValueId),
    /// An expression, whose value nobody needed before.
    Expression {
        key: String,
        expression: Expression,
    },
    /// An expression whose value is being computed.
    InProgress,
}

impl Resolver {
    pub(crate) fn new(builder: ProgramBuilder) -> Self {
        Resolver { builder, meanings: HashMap::new() }
    }

    /// Gives a name a value.
    pub(crate) fn define(&mut self, name: &str, primes: usize, value: ValueId) {
        self.meanings.insert((name.into(), primes), Meaning::Value(value));
    }

    /// Whether a name has a meaning.
    pub(crate) fn defines(&self, name: &str) -> bool {
        self.meanings.contains_key(&(name.to_owned(), 0))
    }

    /// Gives a name the value of an expression.
    pub(crate) fn define_expression(&mut self, own: NamedExpression<'_>) {
        let NamedExpression { name, primes, key, expression } = own;
        self.meanings.insert((name.into(), primes), Meaning::Expression { key, expression });
    }

    /// The value of a name in the definition `key`.
    pub(crate) fn resolve(
        &mut self,
        name: &str,
        primes: usize,
        (key, span): (&str, Option<Range<usize>>),
    ) -> Result<ValueId, EquationError> {
        let full = || format!("{name}{}", "'".repeat(primes));
        let error = |kind| EquationError { key: key.into(), span: span.clone(), kind };
        let Some(meaning) = self.meanings.get_mut(&(name.to_owned(), primes)) else {
            let mut known: Vec<String> = self
                .meanings
                .keys()
                .map(|(name, primes)| format!("{name}{}", "'".repeat(*primes)))
                .collect();
            known.retain(|name| name != ENERGY);
            known.extend(Function::ALL.map(|function| function.name().to_owned()));
            // Time is a degree of freedom only where an equation has it.
            known.extend(["t", "if"].map(str::to_owned));
            known.sort_unstable();
            known.dedup();
            return Err(error(EquationErrorKind::UnknownName { name: full(), known }));
        };
        match core::mem::replace(meaning, Meaning::InProgress) {
            Meaning::Value(value) => {
                *meaning = Meaning::Value(value);
                Ok(value)
            }
            Meaning::InProgress => Err(error(EquationErrorKind::Circle(full()))),
            Meaning::Expression { key, expression } => {
                let value = self.evaluate(&key, &expression)?;
                self.define(name, primes, value);
                Ok(value)
            }
        }
    }

    /// The value of an expression of the definition `key`, node by node.
    pub(crate) fn evaluate(
        &mut self,
        key: &str,
        expression: &Expression,
    ) -> Result<ValueId, EquationError> {
        let mut values: Vec<ValueId> = Vec::with_capacity(expression.nodes.len());
        for node in &expression.nodes {
            let value = match &node.kind {
                NodeKind::Number(x) => self.builder.constant(*x),
                NodeKind::Name { name, primes } => {
                    self.resolve(name, *primes, (key, Some(node.span.clone())))?
                }
                NodeKind::Negative(a) => self.builder.value(Operation::Negative(values[*a])),
                NodeKind::Operation(operator, [a, b]) => {
                    self.operation(*operator, values[*a], values[*b])
                }
                NodeKind::Call(function, arguments) => {
                    let last = arguments[function.arity() - 1];
                    let operands = [values[arguments[0]], values[last]];
                    self.builder.value(Operation::Call(*function, operands))
                }
                NodeKind::Choice { comparison, sides: [a, b], values: [then, otherwise] } => {
                    let (or_equal, [a, b]) = match comparison {
                        Comparison::Less => (false, [a, b]),
                        Comparison::LessOrEqual => (true, [a, b]),
                        Comparison::Greater => (false, [b, a]),
                        Comparison::GreaterOrEqual => (true, [b, a]),
                    };
                    let operands = [a, b, then, otherwise].map(|node| values[*node]);
                    self.builder.value(Operation::Choice(or_equal, operands))
                }
            };
            values.push(value);
        }
        // An expression has at least one node.
        Ok(values.pop().unwrap_or_default())
    }

    fn operation(&mut self, operator: Operator, a: ValueId, b: ValueId) -> ValueId {
        match operator {
            Operator::Sum => self.builder.value(Operation::Sum(a, b)),
            Operator::Difference => self.builder.value(Operation::Difference(a, b)),
            Operator::Product => self.builder.value(Operation::Product(a, b)),
            Operator::Quotient => self.builder.value(Operation::Quotient(a, b)),
            Operator::Power => self.power(a, b),
        }
    }
}

impl Resolver {
    /// `a^b`: whole powers by products, a power of a half by a root, others by `exp(b log(a))`.
    fn power(&mut self, a: ValueId, b: ValueId) -> ValueId {
        let exponent = self.builder.as_constant(b);
        match exponent.map(|b| (b, b as i32)) {
            Some((b, whole)) if f64::from(whole) == b => self.builder.whole_power(a, whole),
            Some((0.5, _)) => self.builder.value(Operation::Call(Function::Sqrt, [a, a])),
            _ => {
                let logarithm = self.builder.value(Operation::Call(Function::Log, [a, a]));
                let product = self.builder.value(Operation::Product(b, logarithm));
                self.builder.value(Operation::Call(Function::Exp, [product, product]))
            }
        }
    }
}
