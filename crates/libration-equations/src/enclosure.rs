//! Values of programs over boxes of inputs, by interval arithmetic.

use core::f64::consts::{FRAC_PI_2, PI, TAU};

use super::Function;
use super::program::{Operation, Program};

/// The least and the largest value of a quantity.
pub type Interval = [f64; 2];

/// All numbers: what is not known.
const ALL: Interval = [f64::NEG_INFINITY, f64::INFINITY];

/// Angles beyond this are not reduced: a sine of them is anything from −1 to 1.
const MOST_ANGLE: f64 = 1e6;

impl Program {
    /// The program over boxes of inputs.
    pub fn enclosure(&self) -> Enclosure<'_> {
        Enclosure { program: self, values: Vec::with_capacity(self.values.len()) }
    }
}

/// A program over boxes (R. E. Moore, *Interval Analysis*, 1966): each output has no value outside of its interval, but for roundings, which
/// are not added.
///
/// Of a function that is not defined in all of a box the values are those where it is.
#[derive(Clone, Debug)]
pub struct Enclosure<'p> {
    program: &'p Program,
    values: Vec<Interval>,
}

impl Enclosure<'_> {
    /// The intervals of the outputs for inputs within these, in order. Missing inputs are zero.
    pub fn run(&mut self, inputs: &[Interval]) -> impl Iterator<Item = Interval> {
        self.values.clear();
        for operation in &self.program.values {
            let of = |a: usize| self.values[a];
            let [low, high] = match *operation {
                Operation::Input(input) => inputs.get(input).copied().unwrap_or_default(),
                Operation::Constant(c) => [c, c],
                Operation::Sum(a, b) => sum(of(a), of(b)),
                Operation::Difference(a, b) => sum(of(a), negative(of(b))),
                Operation::Product(a, b) if a == b => square(of(a)),
                Operation::Product(a, b) => product(of(a), of(b)),
                Operation::Quotient(a, b) => product(of(a), reciprocal(of(b))),
                Operation::Negative(a) => negative(of(a)),
                Operation::Reciprocal(a) => reciprocal(of(a)),
                Operation::Ratio(a, num, den) => {
                    let ratio = f64::from(num) / f64::from(den);
                    product(of(a), [ratio, ratio])
                }
                Operation::Call(function, [a, b]) => call(function, of(a), of(b)),
                Operation::Choice(_, [a, b, then, otherwise]) => {
                    let (a, b) = (of(a), of(b));
                    match () {
                        () if a[1] < b[0] => of(then),
                        () if a[0] > b[1] => of(otherwise),
                        () => hull(of(then), of(otherwise)),
                    }
                }
            };
            let is_known = !low.is_nan() && !high.is_nan();
            self.values.push(if is_known { [low, high] } else { ALL });
        }
        self.program.outputs.iter().map(|&output| self.values[output])
    }
}

fn sum([a, b]: Interval, [c, d]: Interval) -> Interval {
    [a + c, b + d]
}

fn negative([a, b]: Interval) -> Interval {
    [-b, -a]
}

fn hull([a, b]: Interval, [c, d]: Interval) -> Interval {
    [a.min(c), b.max(d)]
}

/// The interval of sizes.
fn size([a, b]: Interval) -> Interval {
    match (a >= 0.0, b <= 0.0) {
        (true, _) => [a, b],
        (_, true) => [-b, -a],
        _ => [0.0, b.max(-a)],
    }
}

fn square(of: Interval) -> Interval {
    size(of).map(|x| x * x)
}

fn product([a, b]: Interval, [c, d]: Interval) -> Interval {
    // Zero times what has no bound: an end of the interval, not a value.
    let times = |x: f64, y: f64| if x == 0.0 || y == 0.0 { 0.0 } else { x * y };
    let ends = [times(a, c), times(a, d), times(b, c), times(b, d)];
    let low = ends.into_iter().fold(f64::INFINITY, f64::min);
    [low, ends.into_iter().fold(f64::NEG_INFINITY, f64::max)]
}

fn reciprocal([a, b]: Interval) -> Interval {
    match () {
        () if a > 0.0 || b < 0.0 => [b.recip(), a.recip()],
        () if a == 0.0 && b > 0.0 => [b.recip(), f64::INFINITY],
        () if b == 0.0 && a < 0.0 => [f64::NEG_INFINITY, a.recip()],
        () => ALL,
    }
}

fn call(function: Function, x: Interval, y: Interval) -> Interval {
    let of = |x: f64| function.of([x, x]);
    // Infinite ends of growing functions have the values of limits.
    let within = |low: f64, high: f64| [x[0].clamp(low, high), x[1].clamp(low, high)];
    match function {
        Function::Cos => wave(function, x, 0.0),
        Function::Sin => wave(function, x, FRAC_PI_2),
        Function::Tan => {
            let turn = |x: f64| (x / PI + 0.5).floor();
            let is_near = size(x)[1] < MOST_ANGLE && x[1] - x[0] < PI;
            if is_near && turn(x[0]) == turn(x[1]) { x.map(of) } else { ALL }
        }
        Function::Asin => within(-1.0, 1.0).map(of),
        Function::Acos => {
            let [low, high] = within(-1.0, 1.0);
            [of(high), of(low)]
        }
        Function::Sqrt | Function::Log => within(0.0, f64::INFINITY).map(|x| match (x, function) {
            (0.0, Function::Log) => f64::NEG_INFINITY,
            (f64::INFINITY, _) => x,
            _ => of(x),
        }),
        Function::Atan | Function::Tanh => within(-1e300, 1e300).map(of),
        Function::Exp => x.map(|x| match x {
            f64::NEG_INFINITY => 0.0,
            f64::INFINITY => x,
            _ => of(x),
        }),
        Function::Sinh | Function::Sign => x.map(of),
        Function::Cosh => size(x).map(of),
        Function::Abs => size(x),
        Function::Min => [x[0].min(y[0]), x[1].min(y[1])],
        Function::Max => [x[0].max(y[0]), x[1].max(y[1])],
        Function::Atan2 => angle(x, y),
    }
}

/// A sine or cosine, whose maximum is at `top`.
fn wave(function: Function, [a, b]: Interval, top: f64) -> Interval {
    if !(b - a < TAU && a.abs().max(b.abs()) < MOST_ANGLE) {
        return [-1.0, 1.0];
    }
    let of = |x: f64| function.of([x, x]);
    let has = |at: f64| ((a - at) / TAU).ceil() <= ((b - at) / TAU).floor();
    let [low, high] = hull([of(a); 2], [of(b); 2]);
    [if has(top + PI) { -1.0 } else { low }, if has(top) { 1.0 } else { high }]
}

/// Angles of points with these `y` and `x`.
fn angle(y: Interval, x: Interval) -> Interval {
    // Left of the origin the angle jumps from −π to π.
    if !(x[0] > 0.0 || y[0] > 0.0 || y[1] < 0.0) {
        return [-PI, PI];
    }
    let of = |y: f64, x: f64| Function::Atan2.of([y, x]);
    let ends = [of(y[0], x[0]), of(y[0], x[1]), of(y[1], x[0]), of(y[1], x[1])];
    let low = ends.into_iter().fold(f64::INFINITY, f64::min);
    [low, ends.into_iter().fold(f64::NEG_INFINITY, f64::max)]
}
