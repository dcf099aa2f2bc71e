//! Programs under construction.

use std::collections::HashMap;

use super::Function;
use super::program::{Operation, Program, ValueId, choose};

/// Collects the operations of a program, each once.
#[derive(Clone, Debug, Default)]
pub(crate) struct ProgramBuilder {
    /// Whether operations of constants remain, to be computed in the number type. Otherwise they are computed here in `f64`.
    keeps_constants: bool,
    inputs: usize,
    values: Vec<Operation>,
    known: HashMap<Key, ValueId>,
}

/// An operation with the bits of a constant in place of the constant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Key {
    Input(usize),
    Constant(u64),
    Operation(u8, ValueId, ValueId),
    Ratio(ValueId, i32, i32),
    Call(Function, [ValueId; 2]),
    Choice(bool, [ValueId; 4]),
}

impl ProgramBuilder {
    /// A builder that computes nothing: all operations are those of the number type.
    pub(crate) fn literal() -> Self {
        ProgramBuilder { keeps_constants: true, ..ProgramBuilder::default() }
    }

    /// A new input.
    pub(crate) fn input(&mut self) -> ValueId {
        self.inputs += 1;
        self.value(Operation::Input(self.inputs - 1))
    }

    /// New inputs, in order.
    pub(crate) fn inputs(&mut self, count: usize) -> Vec<ValueId> {
        (0..count).map(|_| self.input()).collect()
    }

    pub(crate) fn constant(&mut self, c: f64) -> ValueId {
        self.value(Operation::Constant(c))
    }

    /// The constant that a value is, if it is one.
    pub(crate) fn as_constant(&self, value: ValueId) -> Option<f64> {
        match self.values[value] {
            Operation::Constant(c) => Some(c),
            _ => None,
        }
    }

    /// The value of an operation: computed here if its operands are constants, and that of the same operation before if there is one.
    pub(crate) fn value(&mut self, operation: Operation) -> ValueId {
        let operation = if self.keeps_constants { operation } else { self.simplified(operation) };
        let key = match operation {
            Operation::Input(i) => Key::Input(i),
            Operation::Constant(c) => Key::Constant(c.to_bits()),
            // Sums and products do not depend on the order of their operands.
            Operation::Sum(a, b) => Key::Operation(0, a.min(b), a.max(b)),
            Operation::Product(a, b) => Key::Operation(1, a.min(b), a.max(b)),
            Operation::Difference(a, b) => Key::Operation(2, a, b),
            Operation::Quotient(a, b) => Key::Operation(3, a, b),
            Operation::Negative(a) => Key::Operation(4, a, a),
            Operation::Reciprocal(a) => Key::Operation(5, a, a),
            Operation::Ratio(a, num, den) => Key::Ratio(a, num, den),
            Operation::Call(function, operands) => Key::Call(function, operands),
            Operation::Choice(or_equal, operands) => Key::Choice(or_equal, operands),
        };
        *self.known.entry(key).or_insert_with(|| {
            self.values.push(operation);
            self.values.len() - 1
        })
    }

    /// A simpler operation with the same bits: the constant that it is, a reciprocal or a ratio.
    fn simplified(&self, operation: Operation) -> Operation {
        let of = |value: ValueId| self.as_constant(value);
        let both = |a: ValueId, b: ValueId, f: fn(f64, f64) -> f64| {
            of(a).zip(of(b)).map_or(operation, |(a, b)| Operation::Constant(f(a, b)))
        };
        match operation {
            Operation::Sum(a, b) => both(a, b, |a, b| a + b),
            Operation::Difference(a, b) => both(a, b, |a, b| a - b),
            Operation::Product(a, b) => both(a, b, |a, b| a * b),
            Operation::Quotient(a, b) => match (of(a), of(b)) {
                (Some(a), Some(b)) => Operation::Constant(a / b),
                (Some(1.0), None) => Operation::Reciprocal(b),
                (None, Some(b)) => match whole(b) {
                    Some(den) => Operation::Ratio(a, 1, den),
                    None => operation,
                },
                _ => operation,
            },
            Operation::Negative(a) => of(a).map_or(operation, |a| Operation::Constant(-a)),
            Operation::Reciprocal(a) => of(a).map_or(operation, |a| Operation::Constant(a.recip())),
            Operation::Ratio(a, num, den) => of(a)
                .map_or(operation, |a| Operation::Constant(a * f64::from(num) / f64::from(den))),
            Operation::Call(function, [a, b]) => match (of(a), of(b)) {
                (Some(a), Some(b)) => Operation::Constant(function.of([a, b])),
                _ => operation,
            },
            Operation::Choice(or_equal, [a, b, then, otherwise]) => {
                match (of(a), of(b), of(then), of(otherwise)) {
                    (Some(a), Some(b), Some(then), Some(otherwise)) => {
                        Operation::Constant(choose(or_equal, [a, b, then, otherwise]))
                    }
                    _ => operation,
                }
            }
            Operation::Input(_) | Operation::Constant(_) => operation,
        }
    }

    /// A whole power: by squares, `x³ = x²·x`, `x⁴ = (x²)²`, `x⁻ⁿ = 1/xⁿ`.
    pub(crate) fn whole_power(&mut self, x: ValueId, exponent: i32) -> ValueId {
        match exponent {
            0 => self.constant(1.0),
            ..0 => {
                let power = self.positive_power(x, exponent.unsigned_abs());
                self.value(Operation::Reciprocal(power))
            }
            _ => self.positive_power(x, exponent.unsigned_abs()),
        }
    }

    fn positive_power(&mut self, x: ValueId, exponent: u32) -> ValueId {
        match exponent {
            0 | 1 => x,
            _ if exponent.is_multiple_of(2) => {
                let root = self.positive_power(x, exponent / 2);
                self.value(Operation::Product(root, root))
            }
            _ => {
                let rest = self.positive_power(x, exponent - 1);
                self.value(Operation::Product(rest, x))
            }
        }
    }

    /// The outputs of a program on these inputs, as a part of this one.
    pub(crate) fn inline(&mut self, program: &Program, inputs: &[ValueId]) -> Vec<ValueId> {
        let mut places: Vec<ValueId> = Vec::with_capacity(program.values.len());
        for operation in &program.values {
            places.push(match *operation {
                Operation::Input(input) => inputs[input],
                operation => self.value(operation.moved(&places)),
            });
        }
        program.outputs.iter().map(|&output| places[output]).collect()
    }

    /// The program with these outputs, and without what they do not need.
    pub(crate) fn finish(self, outputs: &[ValueId]) -> Program {
        without_unused(self.values, outputs)
    }
}

/// The program of the values that these outputs need.
fn without_unused(all: Vec<Operation>, outputs: &[ValueId]) -> Program {
    let mut needed = vec![false; all.len()];
    outputs.iter().for_each(|&output| needed[output] = true);
    for i in (0..all.len()).rev() {
        if needed[i] {
            all[i].operands().for_each(|operand| needed[operand] = true);
        }
    }
    let mut places = vec![0; all.len()];
    let mut values = Vec::new();
    for (i, operation) in all.into_iter().enumerate() {
        if needed[i] {
            places[i] = values.len();
            values.push(operation.moved(&places));
        }
    }
    let outputs = outputs.iter().map(|&output| places[output]).collect();
    Program { values, outputs }
}

impl Program {
    /// The part of the program that computes these of its values.
    pub fn part(&self, outputs: &[ValueId]) -> Program {
        without_unused(self.values.clone(), outputs)
    }

    /// Whether output `i` may be infinite or NaN although no input is large.
    pub(crate) fn is_partial(&self, i: usize) -> bool {
        let part = self.part(&[self.outputs[i]]);
        part.values.iter().any(|operation| match *operation {
            Operation::Quotient(_, b) => {
                !matches!(part.values[b], Operation::Constant(c) if c != 0.0)
            }
            Operation::Reciprocal(_) => true,
            Operation::Call(function, _) => function.is_partial(),
            _ => false,
        })
    }

    /// Whether output `i` depends on input `input`.
    pub(crate) fn depends_on(&self, i: usize, input: usize) -> bool {
        self.part(&[self.outputs[i]]).values.contains(&Operation::Input(input))
    }
}

/// The integer that a number is, if it is a small one.
fn whole(x: f64) -> Option<i32> {
    let whole = x as i32;
    (f64::from(whole) == x && whole != 0).then_some(whole)
}
