//! From the values of a program to actions on rows: uniform values apart, signs in constants, pairs of operations as one action.

use std::collections::HashMap;

use libration_equations::{Operation, Program, ValueId};

use super::instruction::Action;

/// A value that differs between lanes or does not.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Source {
    /// A row at the start.
    Input(usize),
    /// The result of a node.
    Node(usize),
    /// A uniform value.
    Uniform(usize),
}

/// An action on sources.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Node {
    pub(super) action: Action,
    pub(super) operands: [Source; 4],
}

impl Node {
    fn new(action: Action, operands: &[Source]) -> Self {
        let first = operands[0];
        let of = |i: usize| operands.get(i).copied().unwrap_or(first);
        Node { action, operands: [of(0), of(1), of(2), of(3)] }
    }

    pub(super) fn sources(&self) -> &[Source] {
        &self.operands[..self.action.arity()]
    }
}

/// The origin of a uniform value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Uniform {
    /// A value of the program.
    Value(ValueId),
    /// The negative of a value of the program.
    Negative(ValueId),
    /// A constant.
    Constant(f64),
}

/// The nodes of a program.
#[derive(Debug, Default)]
pub(super) struct Lowering {
    pub(super) nodes: Vec<Node>,
    pub(super) uniforms: Vec<Uniform>,
    known: HashMap<(u8, u64), usize>,
}

impl Lowering {
    /// The nodes of a program whose input `i` is a row at the start or uniform, and the sources of its outputs.
    pub(super) fn new(
        program: &Program,
        row_of_input: impl Fn(usize) -> Option<usize>,
    ) -> (Self, Vec<Source>) {
        let mut lowering = Lowering::default();
        let mut sources: Vec<Source> = Vec::with_capacity(program.values().len());
        for (id, &operation) in program.values().iter().enumerate() {
            let is_uniform = |a: ValueId| matches!(sources[a], Source::Uniform(_));
            let source = match operation {
                Operation::Input(i) => match row_of_input(i) {
                    Some(row) => Source::Input(row),
                    None => lowering.uniform(Uniform::Value(id)),
                },
                _ if operation.operands().all(is_uniform) => lowering.uniform(Uniform::Value(id)),
                _ => lowering.lowered(operation, &sources),
            };
            sources.push(source);
        }
        let outputs: Vec<Source> = program.outputs().iter().map(|&id| sources[id]).collect();
        let outputs = lowering.fused(&outputs);
        (lowering, outputs)
    }

    fn uniform(&mut self, uniform: Uniform) -> Source {
        let key = match uniform {
            Uniform::Value(id) => (0, id as u64),
            Uniform::Negative(id) => (1, id as u64),
            Uniform::Constant(c) => (2, c.to_bits()),
        };
        Source::Uniform(*self.known.entry(key).or_insert_with(|| {
            self.uniforms.push(uniform);
            self.uniforms.len() - 1
        }))
    }

    fn node(&mut self, action: Action, operands: &[Source]) -> Source {
        self.nodes.push(Node::new(action, operands));
        Source::Node(self.nodes.len() - 1)
    }

    /// A node for an operation with an operand that differs between lanes.
    fn lowered(&mut self, operation: Operation, sources: &[Source]) -> Source {
        let of = |a: ValueId| sources[a];
        match operation {
            Operation::Input(_) | Operation::Constant(_) => {
                unreachable!("they have no operands that differ")
            }
            Operation::Sum(a, b) => self.sum(of(a), of(b)),
            Operation::Difference(a, b) => match self.negated(of(b)) {
                Some(x) => self.sum(of(a), x),
                None => self.node(Action::Difference, &[of(a), of(b)]),
            },
            Operation::Product(a, b) => self.product(of(a), of(b)),
            Operation::Quotient(a, b) => self.node(Action::Quotient, &[of(a), of(b)]),
            Operation::Negative(a) => {
                let minus = self.uniform(Uniform::Constant(-1.0));
                self.product(of(a), minus)
            }
            Operation::Reciprocal(a) => {
                let one = self.uniform(Uniform::Constant(1.0));
                self.node(Action::Quotient, &[one, of(a)])
            }
            Operation::Ratio(a, num, den) => self.ratio(of(a), num, den),
            Operation::Call(function, operands) => {
                let operands = operands.map(of);
                self.node(Action::Call(function), &operands[..function.arity()])
            }
            Operation::Choice(or_equal, operands) => {
                self.node(Action::Choice(or_equal), &operands.map(of))
            }
        }
    }

    /// `x·num/den`, by a power of two as a product, which has the same rounding.
    fn ratio(&mut self, x: Source, num: i32, den: i32) -> Source {
        let x = match num {
            1 => x,
            _ => {
                let num = self.uniform(Uniform::Constant(num.into()));
                self.product(x, num)
            }
        };
        match den {
            1 => x,
            _ if den.unsigned_abs().is_power_of_two() => {
                let factor = self.uniform(Uniform::Constant(f64::from(den).recip()));
                self.product(x, factor)
            }
            _ => {
                let den = self.uniform(Uniform::Constant(den.into()));
                self.node(Action::Quotient, &[x, den])
            }
        }
    }

    fn sum(&mut self, x: Source, y: Source) -> Source {
        match (self.negated(x), self.negated(y)) {
            (_, Some(y)) => self.node(Action::Difference, &[x, y]),
            (Some(x), None) => self.node(Action::Difference, &[y, x]),
            (None, None) => {
                let [x, y] = uniform_last([x, y]);
                self.node(Action::Sum, &[x, y])
            }
        }
    }

    /// A product with a uniform factor at the end, whose sign is that of all.
    fn product(&mut self, x: Source, y: Source) -> Source {
        let [x, y] = uniform_last([x, y]);
        if let (Some(x), Source::Uniform(u)) = (self.negated(x), y) {
            let opposite = self.opposite(u);
            return self.node(Action::Product, &[x, opposite]);
        }
        if let (Source::Node(n), true) = (x, self.is_minus_one(y))
            && let Node { action: Action::Product, operands: [x, Source::Uniform(u), ..] } =
                self.nodes[n]
        {
            let opposite = self.opposite(u);
            return self.node(Action::Product, &[x, opposite]);
        }
        self.node(Action::Product, &[x, y])
    }

    fn opposite(&mut self, uniform: usize) -> Source {
        let opposite = match self.uniforms[uniform] {
            Uniform::Value(id) => Uniform::Negative(id),
            Uniform::Negative(id) => Uniform::Value(id),
            Uniform::Constant(c) => Uniform::Constant(-c),
        };
        self.uniform(opposite)
    }

    fn is_minus_one(&self, source: Source) -> bool {
        matches!(source, Source::Uniform(u) if self.uniforms[u] == Uniform::Constant(-1.0))
    }

    /// `x`, if the source is `−x`.
    fn negated(&self, source: Source) -> Option<Source> {
        let Source::Node(n) = source else { return None };
        let Node { action, operands: [x, y, ..] } = self.nodes[n];
        (action == Action::Product && self.is_minus_one(y)).then_some(x)
    }

    /// Makes one action of two wherever nothing else needs the result of the first; gives the new outputs.
    ///
    /// What nothing needs any more is left out.
    fn fused(&mut self, outputs: &[Source]) -> Vec<Source> {
        let uses = self.uses(outputs);
        for n in 0..self.nodes.len() {
            let Node { action, operands: [x, y, ..] } = self.nodes[n];
            // The first of two operations, if this node alone needs it.
            let part = |source: Source, wanted: Action| match source {
                Source::Node(p) if uses[p] == 1 && self.nodes[p].action == wanted => {
                    let [a, b, ..] = self.nodes[p].operands;
                    Some([a, b])
                }
                _ => None,
            };
            let (product, sum) = (Action::Product, Action::Sum);
            let fused = match action {
                Action::Sum => part(x, product)
                    .map(|pair| (Action::ProductSum, pair, y))
                    .or_else(|| part(y, product).map(|pair| (Action::ProductSum, pair, x)))
                    .or_else(|| part(x, sum).map(|pair| (Action::SumSum, pair, y)))
                    .or_else(|| part(y, sum).map(|pair| (Action::SumSum, pair, x))),
                Action::Difference => part(y, product)
                    .map(|pair| (Action::DifferenceOfProduct, pair, x))
                    .or_else(|| part(x, product).map(|pair| (Action::ProductDifference, pair, y))),
                Action::Product => part(x, product)
                    .map(|pair| (Action::ProductProduct, pair, y))
                    .or_else(|| part(y, product).map(|pair| (Action::ProductProduct, pair, x)))
                    .or_else(|| part(x, sum).map(|pair| (Action::SumProduct, pair, y)))
                    .or_else(|| part(y, sum).map(|pair| (Action::SumProduct, pair, x))),
                _ => None,
            };
            if let Some((action, [a, b], c)) = fused {
                self.nodes[n] = Node::new(action, &[a, b, c]);
            }
        }
        let uses = self.uses(outputs);
        let mut places = vec![0; self.nodes.len()];
        let mut kept: Vec<Node> = Vec::new();
        let moved = |source: Source, places: &[usize]| match source {
            Source::Node(n) => Source::Node(places[n]),
            other => other,
        };
        for (n, node) in self.nodes.iter().enumerate() {
            if uses[n] > 0 {
                places[n] = kept.len();
                let operands = node.operands.map(|source| moved(source, &places));
                kept.push(Node { operands, ..*node });
            }
        }
        self.nodes = kept;
        outputs.iter().map(|&source| moved(source, &places)).collect()
    }

    /// How often each node is needed for the outputs.
    fn uses(&self, outputs: &[Source]) -> Vec<u32> {
        let mut uses = vec![0; self.nodes.len()];
        let count = |source: &Source, uses: &mut Vec<u32>| {
            if let Source::Node(n) = *source {
                uses[n] += 1;
            }
        };
        outputs.iter().for_each(|source| count(source, &mut uses));
        for n in (0..self.nodes.len()).rev() {
            if uses[n] > 0 {
                self.nodes[n].sources().iter().for_each(|source| count(source, &mut uses));
            }
        }
        uses
    }
}

/// Two operands whose order does not matter, a uniform one last.
fn uniform_last([x, y]: [Source; 2]) -> [Source; 2] {
    match x {
        Source::Uniform(_) => [y, x],
        _ => [x, y],
    }
}
