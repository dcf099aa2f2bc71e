//! Expressions on number types that must agree.

use libration::equations::{Function, Operation, Program};
use libration::number::{Dual, Wide};
use libration::{Elementary, Scalar};
use proptest::prelude::*;

use super::random_expressions::{equations, expression, smooth_expression};

/// The program of an acceleration, from positions, velocities and no input.
fn program(text: &str) -> Program {
    let accelerations = vec![("x".to_owned(), text.to_owned()), ("y".to_owned(), "t".to_owned())];
    let equations = equations(accelerations, vec![("s".to_owned(), "0".to_owned())]);
    equations.dynamics().accelerations().clone()
}

/// Where programs are evaluated: positions of x, y, s and time, then their velocities.
const POINT: [f64; 8] = [0.3, -1.1, 0.0, 0.7, 0.9, -0.4, 1.7, 1.0];

fn first<T: Elementary>(program: &Program, point: [T; 8]) -> T {
    program.on::<T>().run(&point).next().unwrap()
}

/// What the roundings of a run in `f64` change in the first output, to first order: a unit of roundoff of each value, two of a function
/// (whose errors are below 0.87 ulp), times the derivative of the output by that value.
fn rounding_bound(program: &Program) -> f64 {
    let values: Vec<f64> = {
        let outputs: Vec<usize> = (0..program.values().len()).collect();
        program.part(&outputs).on::<f64>().run(&POINT).collect()
    };
    let mut slopes = vec![0.0; values.len()];
    slopes[program.outputs()[0]] = 1.0;
    let mut bound = 0.0;
    for (id, operation) in program.values().iter().enumerate().rev() {
        let (slope, v) = (slopes[id], |a: usize| values[a]);
        let roundings = match operation {
            Operation::Input(_) => 0.0,
            Operation::Call(..) => 2.0,
            _ => 1.0,
        };
        bound += (slope * values[id]).abs() * roundings * f64::EPSILON / 2.0;
        let mut add = |a: usize, by: f64| slopes[a] += slope * by;
        match *operation {
            Operation::Input(_) | Operation::Constant(_) | Operation::Choice(..) => {}
            Operation::Sum(a, b) => (add(a, 1.0), add(b, 1.0)).0,
            Operation::Difference(a, b) => (add(a, 1.0), add(b, -1.0)).0,
            Operation::Product(a, b) => (add(a, v(b)), add(b, v(a))).0,
            Operation::Quotient(a, b) => (add(a, 1.0 / v(b)), add(b, -v(a) / v(b).powi(2))).0,
            Operation::Negative(a) => add(a, -1.0),
            Operation::Reciprocal(a) => add(a, -1.0 / v(a).powi(2)),
            Operation::Ratio(a, num, den) => add(a, f64::from(num) / f64::from(den)),
            Operation::Call(Function::Atan2, [a, b]) => {
                let square = v(a).powi(2) + v(b).powi(2);
                add(a, v(b) / square);
                add(b, -v(a) / square);
            }
            Operation::Call(function, [a, _]) => add(a, slope_of(function, v(a), values[id])),
        }
    }
    bound
}

/// The derivative of a smooth function of one argument, by its value.
fn slope_of(function: Function, x: f64, value: f64) -> f64 {
    match function {
        Function::Sin => x.cos(),
        Function::Cos => -x.sin(),
        Function::Tan => 1.0 + value * value,
        Function::Atan => 1.0 / (1.0 + x * x),
        Function::Sinh => x.cosh(),
        Function::Cosh => x.sinh(),
        Function::Tanh => 1.0 - value * value,
        Function::Exp => value,
        Function::Log => 1.0 / x,
        Function::Sqrt => 0.5 / value,
        other => unreachable!("{} is not among the smooth functions", other.name()),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn the_value_of_a_dual_number_has_the_bits_of_the_float(text in expression()) {
        let program = program(&text);
        let plain = first(&program, POINT);
        let dual = first(&program, POINT.map(Dual::variable)).re;
        prop_assert!(plain.to_bits() == dual.to_bits() || plain.is_nan() && dual.is_nan());
    }

    #[test]
    fn a_float_differs_from_1024_bits_by_its_roundings(text in smooth_expression()) {
        let program = program(&text);
        let found = first(&program, POINT);
        let exact = first(&program, POINT.map(Wide::from_f64));
        let bound = rounding_bound(&program);
        // Where roundings are a part of the value their squares count.
        prop_assume!(found.is_finite() && bound <= 1e-6 * found.abs());
        let error = (exact - Wide::from_f64(found)).to_f64().abs();
        // The squares, and subnormal numbers.
        prop_assert!(error <= 1.001 * bound + f64::MIN_POSITIVE, "{text}: {error} of {bound}");
    }

    #[test]
    fn the_derivative_of_a_dual_number_is_that_of_differences(text in smooth_expression()) {
        let program = program(&text);
        let at = POINT.map(Wide::from_f64);
        let found = first(&program, at.map(Dual::variable)).du;
        // 2⁻²⁰⁰: the error of the difference is its square times a third derivative.
        let step = (0..200).fold(Wide::one(), |step, _| step.ratio(1, 2));
        let [below, above] = [-step, step].map(|step| first(&program, at.map(|x| x + step)));
        let difference = (above - below) * (step + step).recip();
        prop_assume!(found.to_f64().is_finite() && difference.to_f64().is_finite());
        let error = (found - difference).to_f64().abs();
        prop_assert!(error <= 1e-60 * found.to_f64().abs().max(1.0), "{text}: {error}");
    }
}
