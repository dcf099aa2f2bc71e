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
    /// A function by its name in [`Elementary`].
    Function(&'static str),
}

impl Kind {
    fn operation(self) -> Operation {
        match self {
            Kind::Sum | Kind::Difference => Operation::Addition,
            Kind::Product => Operation::Multiplication,
            Kind::Quotient | Kind::Reciprocal => Operation::Division,
            Kind::Function(_) => Operation::Function,
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

    /// A function of values, or of constants, of which it is one itself.
    fn function<const N: usize>(
        operands: [Self; N],
        kind: Kind,
        on: impl FnOnce([f64; N]) -> f64,
    ) -> Self {
        let trace = operands.iter().find_map(|operand| match operand {
            Constant(_) => None,
            Value { trace, .. } => Some(*trace),
        });
        let Some(trace) = trace else {
            return Constant(on(operands.map(|operand| match operand {
                Constant(c) => c,
                Value { .. } => f64::NAN,
            })));
        };
        let operand = |operand: Self| match operand {
            Constant(c) => Operand::Constant(c.to_bits()),
            Value { node, negative, .. } => Operand::Value(node, negative),
        };
        trace.result(kind, operands.map(operand).to_vec(), false)
    }

    /// A choice by the order of two numbers, done if both are constants.
    fn select(
        operands: [Self; 4],
        name: &'static str,
        holds: impl FnOnce(f64, f64) -> bool,
    ) -> Self {
        let [a, b, then, otherwise] = operands;
        match (a, b) {
            (Constant(a), Constant(b)) if holds(a, b) => then,
            (Constant(_), Constant(_)) => otherwise,
            _ => TracedScalar::function(operands, Kind::Function(name), |_| f64::NAN),
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

/// Functions that are recorded by their names.
macro_rules! recorded {
    ($($function:ident($($other:ident)?))*) => {$(
        fn $function(self $(, $other: Self)?) -> Self {
            let kind = Kind::Function(stringify!($function));
            TracedScalar::function([self $(, $other)?], kind, |[x $(, $other)?]| {
                Elementary::$function(x $(, $other)?)
            })
        }
    )*};
}

impl Elementary for TracedScalar<'_> {
    recorded! {
        sqrt() sin() cos() tan() asin() acos() atan() atan2(other) exp() ln() sinh() cosh() tanh()
        abs() min(other) max(other) signum()
    }

    fn recip(self) -> Self {
        TracedScalar::function([self], Kind::Reciprocal, |[x]| x.recip())
    }

    fn select_less(self, other: Self, then: Self, otherwise: Self) -> Self {
        TracedScalar::select([self, other, then, otherwise], "select_less", |a, b| a < b)
    }

    fn select_equal(self, other: Self, then: Self, otherwise: Self) -> Self {
        TracedScalar::select([self, other, then, otherwise], "select_equal", |a, b| a == b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn functions_of_values_are_recorded_once_and_those_of_constants_are_computed() {
        let trace = OperationTrace::default();
        let (x, c) = (trace.input(), TracedScalar::from_f64);
        let node = |scalar: TracedScalar<'_>| scalar.node();
        assert!(node(x.exp()).is_some() && node(x.exp()) == node(x.exp()));
        assert!(node(x.exp()) != node((-x).exp()) && node(x.exp()) != node(x.ln()));
        assert!(node(x.atan2(c(2.0))) != node(c(2.0).atan2(x)));
        assert!(node(x.min(c(2.0))) != node(x.max(c(2.0))));
        assert!(matches!(c(0.5).atan2(c(-2.0)), Constant(y) if y == Elementary::atan2(0.5, -2.0)));
        assert!(matches!(c(0.5).tanh(), Constant(y) if y == Elementary::tanh(0.5)));
        // A choice by constants is the chosen value, and by a value it is an operation.
        assert!(node(c(1.0).select_less(c(2.0), x, c(0.0))) == node(x));
        assert!(node(c(2.0).select_equal(c(1.0), x, c(0.0))).is_none());
        let chosen = x.select_less(c(2.0), c(1.0), c(0.0));
        assert!(
            node(chosen).is_some() && node(chosen) != node(x.select_equal(c(2.0), c(1.0), c(0.0)))
        );
        let nodes = trace.into_nodes();
        assert_eq!(nodes.iter().filter(|node| **node == Node::Input).count(), 1);
        let function =
            |node: &Node| matches!(node, Node::Result(Operation::Function, on) if *on == [0]);
        assert!(nodes[1..].iter().all(function), "{nodes:?}");
    }
}
