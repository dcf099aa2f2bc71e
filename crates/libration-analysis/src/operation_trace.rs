//! A scalar that records the operations on it.

use core::cell::RefCell;
use core::ops::{Add, Mul, Neg, Sub};

use libration_core::{Elementary, Scalar};

use super::data_flow::{Node, Operation};

/// The recorded operations, each once.
#[derive(Debug, Default)]
pub(super) struct OperationTrace {
    values: RefCell<Vec<Origin>>,
}

/// The origin of a value: an input, or an operation on operands.
type Origin = Option<(Kind, Vec<Operand>)>;

/// The kind of an operation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Sum,
    Difference,
    Product,
    Quotient,
    Reciprocal,
    Root,
    Sine,
    Cosine,
}

impl Kind {
    fn operation(self) -> Operation {
        match self {
            Kind::Sum | Kind::Difference => Operation::Addition,
            Kind::Product => Operation::Multiplication,
            Kind::Quotient | Kind::Reciprocal => Operation::Division,
            Kind::Root | Kind::Sine | Kind::Cosine => Operation::Function,
        }
    }
}

/// An operand: an earlier value, negative or not, or a constant by its bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Operand {
    Value(usize, bool),
    Constant(u64),
}

impl OperationTrace {
    /// A value that nothing is known of.
    pub(super) fn input(&self) -> TracedScalar<'_> {
        Value { trace: self, node: self.push(None), negative: false }
    }

    /// The operations in the order in which they were done.
    pub(super) fn into_nodes(self) -> Vec<Node> {
        let value = |operand: &Operand| match operand {
            Operand::Value(node, _) => Some(*node),
            Operand::Constant(_) => None,
        };
        let node = |origin: Origin| match origin {
            None => Node::Input,
            Some((kind, operands)) => {
                Node::Result(kind.operation(), operands.iter().filter_map(value).collect())
            }
        };
        self.values.into_inner().into_iter().map(node).collect()
    }

    fn push(&self, origin: Origin) -> usize {
        let mut values = self.values.borrow_mut();
        values.push(origin);
        values.len() - 1
    }

    /// The value of that origin, which may be known, with its sign changed if `negative`.
    fn result(&self, kind: Kind, operands: Vec<Operand>, negative: bool) -> TracedScalar<'_> {
        let origin = Some((kind, operands));
        let known = self.values.borrow().iter().position(|other| *other == origin);
        let node = known.unwrap_or_else(|| self.push(origin));
        Value { trace: self, node, negative }
    }
}

/// A constant, or a value that depends on the state.
#[derive(Clone, Copy, Debug)]
pub(super) enum TracedScalar<'a> {
    /// The same at every step.
    Constant(f64),
    /// Another at every step.
    Value {
        trace: &'a OperationTrace,
        node: usize,
        /// Whether it is this node with its sign changed.
        negative: bool,
    },
}

use TracedScalar::{Constant, Value};

impl<'a> TracedScalar<'a> {
    /// The node of a value.
    pub(super) fn node(self) -> Option<usize> {
        match self {
            Constant(_) => None,
            Value { node, .. } => Some(node),
        }
    }

    /// The number without its sign, and whether it is negative.
    fn unsigned(self) -> (Operand, bool) {
        match self {
            Constant(c) => (Operand::Constant(c.abs().to_bits()), c.is_sign_negative()),
            Value { node, negative, .. } => (Operand::Value(node, false), negative),
        }
    }

    /// Whether this is the constant `c`, but for its sign.
    fn is(self, c: f64) -> bool {
        matches!(self, Constant(own) if own.abs() == c)
    }

    fn signed(self, negative: bool) -> Self {
        if negative { -self } else { self }
    }

    /// A function of a value, or of a constant.
    fn function(self, kind: Kind, on: impl Fn(f64) -> f64) -> Self {
        match self {
            Constant(c) => Constant(on(c)),
            Value { trace, node, negative } => {
                trace.result(kind, vec![Operand::Value(node, negative)], false)
            }
        }
    }
}

impl Add for TracedScalar<'_> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let trace = match (self, other) {
            (Constant(a), Constant(b)) => return Constant(a + b),
            (Value { trace, .. }, _) | (_, Value { trace, .. }) => trace,
        };
        let mut operands = [self.unsigned(), other.unsigned()];
        operands.sort_unstable();
        // The sum of −a and −b is −(a + b), that of −a and b is −(a − b).
        let [(a, negative), (b, other_negative)] = operands;
        let kind = if negative == other_negative { Kind::Sum } else { Kind::Difference };
        trace.result(kind, vec![a, b], negative)
    }
}

impl Sub for TracedScalar<'_> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for TracedScalar<'_> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let trace = match (self, other) {
            (Constant(a), Constant(b)) => return Constant(a * b),
            (Value { trace, .. }, _) | (_, Value { trace, .. }) => trace,
        };
        let mut operands = [self.unsigned(), other.unsigned()];
        // A factor of one is no operation.
        match (self.is(1.0), other.is(1.0)) {
            (true, _) => return other.signed(operands[0].1),
            (_, true) => return self.signed(operands[1].1),
            _ => {}
        }
        operands.sort_unstable();
        let [(a, negative), (b, other_negative)] = operands;
        trace.result(Kind::Product, vec![a, b], negative != other_negative)
    }
}

impl Neg for TracedScalar<'_> {
    type Output = Self;
    fn neg(self) -> Self {
        match self {
            Constant(c) => Constant(-c),
            Value { trace, node, negative } => Value { trace, node, negative: !negative },
        }
    }
}

impl Scalar for TracedScalar<'_> {
    fn from_f64(c: f64) -> Self {
        Constant(c)
    }

    fn ratio(self, num: i32, den: i32) -> Self {
        let product = self * Constant(f64::from(num));
        let (operand, negative) = product.unsigned();
        match product {
            Constant(c) => Constant(c / f64::from(den)),
            // A power of two divides by a multiplication, with the same bits.
            _ if den.unsigned_abs().is_power_of_two() => product * Constant(f64::from(den).recip()),
            Value { trace, .. } => {
                let by = Operand::Constant(f64::from(den).abs().to_bits());
                trace.result(Kind::Quotient, vec![operand, by], negative != (den < 0))
            }
        }
    }
}

impl Elementary for TracedScalar<'_> {
    fn sqrt(self) -> Self {
        self.function(Kind::Root, f64::sqrt)
    }

    fn recip(self) -> Self {
        self.function(Kind::Reciprocal, f64::recip)
    }

    fn sin(self) -> Self {
        self.function(Kind::Sine, Elementary::sin)
    }

    fn cos(self) -> Self {
        self.function(Kind::Cosine, Elementary::cos)
    }
}
