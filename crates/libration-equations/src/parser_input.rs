//! The state of the parser, and what all of its parts do with it.

use core::ops::Range;

use winnow::combinator::opt;
use winnow::error::{ErrMode, ParserError};
use winnow::prelude::*;
use winnow::stream::{LocatingSlice, Location, Stateful, Stream};
use winnow::token::take_while;

use super::expression::{Node, NodeId, NodeKind, Operator};
use super::{ExpressionError, ExpressionErrorKind};

/// The most bytes of an expression.
pub const MAX_LENGTH: usize = 65_536;

/// The most brackets, functions and powers within each other.
const MAX_DEPTH: usize = 100;

pub(super) type Input<'a> = Stateful<LocatingSlice<&'a str>, Tree>;

/// What is parsed so far.
#[derive(Debug, Default)]
pub(super) struct Tree {
    pub(super) nodes: Vec<Node>,
    depth: usize,
}

/// An error; none where an alternative does not apply.
#[derive(Debug)]
pub(super) struct Failure(pub(super) Option<ExpressionError>);

impl<'a> ParserError<Input<'a>> for Failure {
    type Inner = Self;

    fn from_input(_: &Input<'a>) -> Self {
        Failure(None)
    }

    fn into_inner(self) -> Result<Self::Inner, Self> {
        Ok(self)
    }
}

pub(super) type Parsed<T> = Result<T, ErrMode<Failure>>;

/// Runs a parser one level deeper.
pub(super) fn deeper(
    input: &mut Input<'_>,
    parser: fn(&mut Input<'_>) -> Parsed<NodeId>,
) -> Parsed<NodeId> {
    if input.state.depth == MAX_DEPTH {
        let place = input.current_token_start();
        return Err(failure(place..place + 1, ExpressionErrorKind::Depth(MAX_DEPTH)));
    }
    input.state.depth += 1;
    let node = parser(input)?;
    input.state.depth -= 1;
    Ok(node)
}

pub(super) fn space(input: &mut Input<'_>) -> Parsed<()> {
    take_while(0.., char::is_whitespace).void().parse_next(input)
}

pub(super) fn expect(input: &mut Input<'_>, token: char, expected: &'static str) -> Parsed<()> {
    space(input)?;
    match opt(token).parse_next(input)? {
        Some(_) => Ok(()),
        None => Err(unexpected(input, expected)),
    }
}

/// Adds a node that begins there and ends at the last byte that is not a space.
pub(super) fn push(input: &mut Input<'_>, begin: usize, kind: NodeKind) -> NodeId {
    let span = begin..input.previous_token_end();
    input.state.nodes.push(Node { kind, span });
    input.state.nodes.len() - 1
}

pub(super) fn operation(
    input: &mut Input<'_>,
    operator: Operator,
    a: NodeId,
    b: NodeId,
) -> Parsed<NodeId> {
    let begin = input.state.nodes[a].span.start;
    Ok(push(input, begin, NodeKind::Operation(operator, [a, b])))
}

pub(super) fn failure(span: Range<usize>, kind: ExpressionErrorKind) -> ErrMode<Failure> {
    ErrMode::Cut(Failure(Some(ExpressionError { span, kind })))
}

/// What stands where something else is expected.
pub(super) fn found(input: &Input<'_>, expected: &'static str) -> ExpressionErrorKind {
    let found = input.peek_token().map_or_else(|| "the end".into(), |c| format!("`{c}`"));
    ExpressionErrorKind::Unexpected { found, expected }
}

pub(super) fn unexpected(input: &Input<'_>, expected: &'static str) -> ErrMode<Failure> {
    let begin = input.current_token_start();
    let length = input.peek_token().map_or(0, char::len_utf8);
    failure(begin..begin + length, found(input, expected))
}
