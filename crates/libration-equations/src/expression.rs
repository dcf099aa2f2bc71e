//! Expressions as trees.

use core::ops::Range;

use super::Function;

/// A parsed expression. Nodes follow their operands; the last node is the whole expression.
#[derive(Clone, Debug, PartialEq)]
pub struct Expression {
    pub(crate) nodes: Vec<Node>,
}

/// A part of an expression.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Node {
    pub(crate) kind: NodeKind,
    /// The bytes of the text that it takes.
    pub(crate) span: Range<usize>,
}

/// The index of a node.
pub(crate) type NodeId = usize;

/// The kind of a node, with its operands.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum NodeKind {
    Number(f64),
    /// A name with the number of its primes: `x''` has two.
    Name {
        name: String,
        primes: usize,
    },
    Negative(NodeId),
    Operation(Operator, [NodeId; 2]),
    Call(Function, Vec<NodeId>),
    /// `if(a < b, then, otherwise)`.
    Choice {
        comparison: Comparison,
        sides: [NodeId; 2],
        values: [NodeId; 2],
    },
}

/// An operator with two operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Operator {
    Sum,
    Difference,
    Product,
    Quotient,
    Power,
}

/// A comparison of two numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Comparison {
    Less,
    LessOrEqual,
    Greater,
    GreaterOrEqual,
}

impl Expression {
    /// The names in the expression, each with the number of its primes.
    pub fn names(&self) -> impl Iterator<Item = (&str, usize)> {
        self.nodes.iter().filter_map(|node| match &node.kind {
            NodeKind::Name { name, primes } => Some((name.as_str(), *primes)),
            _ => None,
        })
    }
}
