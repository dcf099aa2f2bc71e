//! The grammar of expressions.

use core::ops::Range;

use winnow::ascii::{digit0, digit1};
use winnow::combinator::{
    Infix, alt, dispatch, empty, expression, fail, opt, preceded, repeat, separated, terminated,
};
use winnow::error::ErrMode;
use winnow::prelude::*;
use winnow::stream::{LocatingSlice, Location, Stream};
use winnow::token::{any, one_of, take_while};

use super::expression::{Comparison, Expression, NodeId, NodeKind, Operator};
use super::parser_input::{
    Failure, Input, MAX_LENGTH, Parsed, Tree, deeper, expect, failure, found, operation, push,
    space, unexpected,
};
use super::{ExpressionError, ExpressionErrorKind, Function};

/// The function of a name that stands for the value before a step.
pub(crate) const BEFORE: &str = "before";

/// The name of the value of a state before a step. No expression can have it but by [`BEFORE`].
pub(crate) fn name_before(name: &str) -> String {
    format!("{BEFORE}({name})")
}

impl Expression {
    /// Parses an expression.
    ///
    /// Operators are `+ - * / ^`, in the usual order; `^` binds to the right and stronger than a sign. Names have letters, digits and
    /// `_`, and up to two primes.
    ///
    /// # Errors
    /// [`ExpressionError`]: the text is no expression, or exceeds a limit.
    pub fn parse(text: &str) -> Result<Self, ExpressionError> {
        Expression::parse_as(text, sum)
    }

    /// Parses a comparison of two expressions by `<`, `<=`, `>` or `>=`: an expression that is 1 where it holds, else 0.
    ///
    /// # Errors
    /// As for [`parse`](Expression::parse).
    pub fn parse_condition(text: &str) -> Result<Self, ExpressionError> {
        Expression::parse_as(text, condition)
    }

    fn parse_as(
        text: &str,
        parser: fn(&mut Input<'_>) -> Parsed<NodeId>,
    ) -> Result<Self, ExpressionError> {
        if text.len() > MAX_LENGTH {
            let kind = ExpressionErrorKind::Length(text.len());
            return Err(ExpressionError { span: 0..text.len(), kind });
        }
        let mut input = Input { input: LocatingSlice::new(text), state: Tree::default() };
        let parsed = terminated(parser, space).parse_next(&mut input);
        let parsed = parsed.and_then(|_| match input.peek_token() {
            None => Ok(()),
            Some(_) => Err(unexpected(&input, "an operator or the end")),
        });
        match parsed {
            Ok(()) => Ok(Expression { nodes: input.state.nodes }),
            Err(ErrMode::Cut(Failure(Some(error)))) => Err(error),
            // No alternative applies: every operand says so itself.
            Err(_) => {
                let place = input.current_token_start();
                Err(ExpressionError { span: place..place, kind: found(&input, OPERAND) })
            }
        }
    }
}

/// The texts that begin an operand.
const OPERAND: &str = "a number, a name, a function or `(`";

/// A sum of products.
fn sum(input: &mut Input<'_>) -> Parsed<NodeId> {
    let operator = dispatch! {any;
        '+' => empty.value(Infix::Left(1, |i: &mut Input<'_>, a, b| operation(i, Operator::Sum, a, b))),
        '-' => empty.value(Infix::Left(1, |i: &mut Input<'_>, a, b| operation(i, Operator::Difference, a, b))),
        '*' => empty.value(Infix::Left(2, |i: &mut Input<'_>, a, b| operation(i, Operator::Product, a, b))),
        '/' => empty.value(Infix::Left(2, |i: &mut Input<'_>, a, b| operation(i, Operator::Quotient, a, b))),
        _ => fail,
    };
    expression(operand).infix(preceded(space, operator)).parse_next(input)
}

/// Signs, and what they belong to: a power.
fn operand(input: &mut Input<'_>) -> Parsed<NodeId> {
    space(input)?;
    let begin = input.current_token_start();
    let signs: Vec<char> = repeat(0.., terminated(one_of(['-', '+']), space)).parse_next(input)?;
    let mut node = deeper(input, power)?;
    if signs.iter().filter(|sign| **sign == '-').count() % 2 == 1 {
        node = push(input, begin, NodeKind::Negative(node));
    }
    Ok(node)
}

fn power(input: &mut Input<'_>) -> Parsed<NodeId> {
    let base = atom(input)?;
    match opt(preceded(space, '^')).parse_next(input)? {
        None => Ok(base),
        Some(_) => {
            let exponent = operand(input)?;
            operation(input, Operator::Power, base, exponent)
        }
    }
}

/// A number, a name, a call or an expression in brackets.
fn atom(input: &mut Input<'_>) -> Parsed<NodeId> {
    let begin = input.current_token_start();
    match input.peek_token() {
        Some('(') => {
            any.void().parse_next(input)?;
            let inside = sum(input)?;
            expect(input, ')', "an operator or `)`")?;
            Ok(inside)
        }
        Some(c) if c.is_ascii_digit() || c == '.' => number(input),
        Some(c) if c.is_ascii_alphabetic() || c == '_' => {
            let name: &str = take_while(1.., is_name).parse_next(input)?;
            let primes: usize = take_while(0.., '\'').map(str::len).parse_next(input)?;
            if primes > 2 {
                let kind = ExpressionErrorKind::Primes { name: name.into(), primes };
                return Err(failure(begin..input.current_token_start(), kind));
            }
            let is_call = primes == 0 && opt(preceded(space, '(')).parse_next(input)?.is_some();
            match is_call {
                true => call(input, begin..begin + name.len(), name),
                false => Ok(push(input, begin, NodeKind::Name { name: name.into(), primes })),
            }
        }
        _ => Err(unexpected(input, OPERAND)),
    }
}

fn is_name(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_'
}

fn number(input: &mut Input<'_>) -> Parsed<NodeId> {
    let begin = input.current_token_start();
    let text =
        (digit0, opt(('.', digit0)), opt((one_of(['e', 'E']), opt(one_of(['-', '+'])), digit1)))
            .take()
            .parse_next(input)?;
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(push(input, begin, NodeKind::Number(value))),
        Ok(_) => {
            let span = begin..input.current_token_start();
            Err(failure(span, ExpressionErrorKind::Number(text.into())))
        }
        Err(_) => {
            let found = format!("`{text}`");
            let kind = ExpressionErrorKind::Unexpected { found, expected: OPERAND };
            Err(failure(begin..begin + text.len(), kind))
        }
    }
}

/// The arguments of a function, behind its opening bracket.
fn call(input: &mut Input<'_>, name: Range<usize>, text: &str) -> Parsed<NodeId> {
    match text {
        "if" => return choice(input, name.start),
        BEFORE => return before(input, name.start),
        _ => {}
    }
    let Some(function) = Function::from_name(text) else {
        return Err(failure(name, ExpressionErrorKind::UnknownFunction { name: text.into() }));
    };
    let arguments: Vec<NodeId> = separated(1.., sum, preceded(space, ',')).parse_next(input)?;
    expect(input, ')', "an operator, `,` or `)`")?;
    let (given, expected) = (arguments.len(), function.arity());
    if given != expected {
        let kind = ExpressionErrorKind::Arguments { name: function.name(), given, expected };
        return Err(failure(name.start..input.current_token_start(), kind));
    }
    Ok(push(input, name.start, NodeKind::Call(function, arguments)))
}

/// `a < b, then, otherwise)`.
fn choice(input: &mut Input<'_>, begin: usize) -> Parsed<NodeId> {
    let (comparison, sides) = comparison(input)?;
    expect(input, ',', "an operator or `,`")?;
    let then = sum(input)?;
    expect(input, ',', "an operator or `,`")?;
    let otherwise = sum(input)?;
    expect(input, ')', "an operator or `)`")?;
    Ok(push(input, begin, NodeKind::Choice { comparison, sides, values: [then, otherwise] }))
}

/// `a < b`, as the choice between 1 and 0.
fn condition(input: &mut Input<'_>) -> Parsed<NodeId> {
    let begin = input.current_token_start();
    let (comparison, sides) = comparison(input)?;
    let values = [1.0, 0.0].map(|x| push(input, begin, NodeKind::Number(x)));
    Ok(push(input, begin, NodeKind::Choice { comparison, sides, values }))
}

/// `a < b`.
fn comparison(input: &mut Input<'_>) -> Parsed<(Comparison, [NodeId; 2])> {
    let a = sum(input)?;
    space(input)?;
    let comparison = alt((
        "<=".value(Comparison::LessOrEqual),
        ">=".value(Comparison::GreaterOrEqual),
        '<'.value(Comparison::Less),
        '>'.value(Comparison::Greater),
    ));
    let Some(comparison) = opt(comparison).parse_next(input)? else {
        return Err(unexpected(input, "an operator or a comparison `<`, `<=`, `>`, `>=`"));
    };
    let b = sum(input)?;
    Ok((comparison, [a, b]))
}

/// `x)`: the name of a state, which stands for its value before a step.
fn before(input: &mut Input<'_>, begin: usize) -> Parsed<NodeId> {
    space(input)?;
    let expected = "the name of a state, as in `before(x)`";
    let Some(name) = opt(take_while(1.., is_name)).parse_next(input)? else {
        return Err(unexpected(input, expected));
    };
    let name = name_before(name);
    let primes = take_while(0.., '\'').map(str::len).parse_next(input)?;
    expect(input, ')', "`)`")?;
    Ok(push(input, begin, NodeKind::Name { name, primes }))
}
