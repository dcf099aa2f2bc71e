//! Straight-line programs.

use libration_core::Elementary;

use super::Function;

/// A program without loops and branches: each value follows from inputs, constants and values before it.
#[derive(Clone, Debug, PartialEq)]
pub struct Program {
    pub(crate) values: Vec<Operation>,
    pub(crate) outputs: Vec<ValueId>,
}

/// The index of a value.
pub type ValueId = usize;

/// The origin of a value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Operation {
    /// An input.
    Input(usize),
    /// A constant, rounded to the number type.
    Constant(f64),
    /// `a + b`.
    Sum(ValueId, ValueId),
    /// `a − b`.
    Difference(ValueId, ValueId),
    /// `a·b`.
    Product(ValueId, ValueId),
    /// `a/b`.
    Quotient(ValueId, ValueId),
    /// `−a`.
    Negative(ValueId),
    /// `1/a`.
    Reciprocal(ValueId),
    /// A value times one integer, divided by another.
    Ratio(ValueId, i32, i32),
    /// Of a function of one argument both are the same.
    Call(Function, [ValueId; 2]),
    /// Of `[a, b, then, otherwise]` the third if `a < b`, else the last; if equal as the flag says.
    Choice(bool, [ValueId; 4]),
}

impl Operation {
    /// The values that it takes.
    pub fn operands(self) -> impl Iterator<Item = ValueId> {
        let (operands, count) = match self {
            Operation::Input(_) | Operation::Constant(_) => ([0; 4], 0),
            Operation::Sum(a, b)
            | Operation::Difference(a, b)
            | Operation::Product(a, b)
            | Operation::Quotient(a, b) => ([a, b, 0, 0], 2),
            Operation::Negative(a) | Operation::Reciprocal(a) | Operation::Ratio(a, _, _) => {
                ([a, 0, 0, 0], 1)
            }
            Operation::Call(function, [a, b]) => ([a, b, 0, 0], function.arity()),
            Operation::Choice(_, operands) => (operands, 4),
        };
        operands.into_iter().take(count)
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
            Operation::Call(function, operands) => {
                Operation::Call(function, operands.map(|a| places[a]))
            }
            Operation::Choice(or_equal, operands) => {
                Operation::Choice(or_equal, operands.map(|a| places[a]))
            }
        }
    }
}

impl Program {
    /// The values, each after its operands.
    pub fn values(&self) -> &[Operation] {
        &self.values
    }

    /// The indices of the outputs.
    pub fn outputs(&self) -> &[ValueId] {
        &self.outputs
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
                Operation::Reciprocal(a) => constant(a),
                Operation::Call(_, [a, b]) => constant(a).and(constant(b)),
                Operation::Choice(_, operands) => {
                    operands.into_iter().try_fold(0, |_, a| constant(a))
                }
            });
        }
        self.outputs.iter().map(|&output| degrees[output]).collect()
    }

    /// The first function that has no value for finite arguments, with the first of these; none if all have values.
    pub fn undefined_function(&self, inputs: &[f64]) -> Option<(Function, f64)> {
        let mut run = self.on::<f64>();
        let _ = run.run(inputs).count();
        self.values.iter().zip(&run.values).find_map(|(operation, value)| match operation {
            Operation::Call(function, operands) if !value.is_finite() => {
                let [a, b] = operands.map(|a| run.values[a]);
                (value.is_nan() && a.is_finite() && b.is_finite()).then_some((*function, a))
            }
            _ => None,
        })
    }

    /// Whether output `i` is the constant zero.
    pub(crate) fn is_zero(&self, i: usize) -> bool {
        self.outputs.get(i).is_some_and(|&id| self.values[id] == Operation::Constant(0.0))
    }

    /// Whether all outputs have derivatives: no function has a kink or a jump.
    pub fn is_smooth(&self) -> bool {
        self.values.iter().all(|operation| match operation {
            Operation::Call(function, _) => function.is_smooth(),
            Operation::Choice(..) => false,
            _ => true,
        })
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

/// The third of four numbers if the first is below the second, else the last; if equal as `or_equal` says.
pub(crate) fn choose<S: Elementary>(or_equal: bool, [a, b, then, otherwise]: [S; 4]) -> S {
    match or_equal {
        true => a.select_less_equal(b, then, otherwise),
        false => a.select_less(b, then, otherwise),
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
                Operation::Quotient(a, b) => values[a].quotient(values[b]),
                Operation::Negative(a) => -values[a],
                Operation::Reciprocal(a) => values[a].recip(),
                Operation::Ratio(a, num, den) => values[a].ratio(num, den),
                Operation::Call(function, operands) => function.of(operands.map(|a| values[a])),
                Operation::Choice(or_equal, operands) => {
                    choose(or_equal, operands.map(|a| values[a]))
                }
            };
        }
        self.program.outputs.iter().map(|&output| self.values[output])
    }
}
