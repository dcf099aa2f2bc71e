//! Straight-line programs.

use libration_core::Elementary;

use super::Function;

/// A program without loops and branches: each value follows from inputs, constants and values before it.
#[derive(Clone, Debug, PartialEq)]
pub struct Program {
    pub(crate) inputs: usize,
    pub(crate) values: Vec<Operation>,
    pub(crate) outputs: Vec<ValueId>,
}

/// The index of a value.
pub(crate) type ValueId = usize;

/// The origin of a value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Operation {
    Input(usize),
    Constant(f64),
    Sum(ValueId, ValueId),
    Difference(ValueId, ValueId),
    Product(ValueId, ValueId),
    Quotient(ValueId, ValueId),
    Negative(ValueId),
    Reciprocal(ValueId),
    /// A value times one integer, divided by another.
    Ratio(ValueId, i32, i32),
    Call(Function, ValueId),
}

impl Operation {
    /// The values that it takes.
    pub(crate) fn operands(self) -> impl Iterator<Item = ValueId> {
        let [a, b] = match self {
            Operation::Input(_) | Operation::Constant(_) => [None, None],
            Operation::Sum(a, b)
            | Operation::Difference(a, b)
            | Operation::Product(a, b)
            | Operation::Quotient(a, b) => [Some(a), Some(b)],
            Operation::Negative(a)
            | Operation::Reciprocal(a)
            | Operation::Ratio(a, _, _)
            | Operation::Call(_, a) => [Some(a), None],
        };
        a.into_iter().chain(b)
    }

    /// The same with operands at other places.
    pub(crate) fn moved(self, places: &[ValueId]) -> Self {
        match self {
            Operation::Input(_) | Operation::Constant(_) => self,
            Operation::Sum(a, b) => Operation::Sum(places[a], places[b]),
            Operation::Difference(a, b) => Operation::Difference(places[a], places[b]),
            Operation::Product(a, b) => Operation::Product(places[a], places[b]),
            Operation::Quotient(a, b) => Operation::Quotient(places[a], places[b]),
            Operation::Negative(a) => Operation::Negative(places[a]),
            Operation::Reciprocal(a) => Operation::Reciprocal(places[a]),
            Operation::Ratio(a, num, den) => Operation::Ratio(places[a], num, den),
            Operation::Call(function, a) => Operation::Call(function, places[a]),
        }
    }
}

impl Program {
    /// The number of inputs.
    pub fn inputs(&self) -> usize {
        self.inputs
    }

    /// The number of outputs.
    pub fn outputs(&self) -> usize {
        self.outputs.len()
    }

    /// The number of operations of one evaluation, without inputs and constants.
    pub fn operations(&self) -> usize {
        let counts = |operation: &&Operation| operation.operands().next().is_some();
        self.values.iter().filter(counts).count()
    }

    /// The inputs on which an output depends, in order.
    pub fn inputs_in_use(&self) -> impl Iterator<Item = usize> {
        self.values.iter().filter_map(|operation| match operation {
            Operation::Input(input) => Some(*input),
            _ => None,
        })
    }

    /// The degree of each output as a polynomial of the inputs for which `is_variable` is true; none if it is none.
    pub fn polynomial_degrees(&self, is_variable: impl Fn(usize) -> bool) -> Vec<Option<u32>> {
        let mut degrees: Vec<Option<u32>> = Vec::with_capacity(self.values.len());
        for operation in &self.values {
            let constant = |value: ValueId| degrees[value].filter(|degree| *degree == 0);
            degrees.push(match *operation {
                Operation::Input(input) => Some(u32::from(is_variable(input))),
                Operation::Constant(_) => Some(0),
                Operation::Sum(a, b) | Operation::Difference(a, b) => {
                    degrees[a].zip(degrees[b]).map(|(a, b)| a.max(b))
                }
                Operation::Product(a, b) => {
                    degrees[a].zip(degrees[b]).map(|(a, b)| a.saturating_add(b))
                }
                Operation::Quotient(a, b) => degrees[a].filter(|_| constant(b).is_some()),
                Operation::Negative(a) | Operation::Ratio(a, _, _) => degrees[a],
                Operation::Reciprocal(a) | Operation::Call(_, a) => constant(a),
            });
        }
        self.outputs.iter().map(|&output| degrees[output]).collect()
    }

    /// The program on numbers of type `S`.
    pub fn on<S: Elementary>(&self) -> Evaluation<'_, S> {
        let constant = |operation: &Operation| match operation {
            Operation::Constant(c) => S::from_f64(*c),
            _ => S::zero(),
        };
        Evaluation { program: self, values: self.values.iter().map(constant).collect() }
    }
}

/// A program with its values on numbers of type `S`.
#[derive(Clone, Debug)]
pub struct Evaluation<'p, S> {
    program: &'p Program,
    values: Vec<S>,
}

impl<S: Elementary> Evaluation<'_, S> {
    /// The outputs for these inputs, in order.
    ///
    /// Missing inputs are zero.
    pub fn run(&mut self, inputs: &[S]) -> impl Iterator<Item = S> {
        for (i, operation) in self.program.values.iter().enumerate() {
            let values = &self.values;
            self.values[i] = match *operation {
                Operation::Input(input) => inputs.get(input).copied().unwrap_or_else(S::zero),
                // It is there from the beginning.
                Operation::Constant(_) => continue,
                Operation::Sum(a, b) => values[a] + values[b],
                Operation::Difference(a, b) => values[a] - values[b],
                Operation::Product(a, b) => values[a] * values[b],
                Operation::Quotient(a, b) => values[a] * values[b].recip(),
                Operation::Negative(a) => -values[a],
                Operation::Reciprocal(a) => values[a].recip(),
                Operation::Ratio(a, num, den) => values[a].ratio(num, den),
                Operation::Call(function, a) => function.of(values[a]),
            };
        }
        self.program.outputs.iter().map(|&output| self.values[output])
    }
}
