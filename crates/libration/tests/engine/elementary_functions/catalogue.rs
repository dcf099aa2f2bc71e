//! The functions of one argument under test, with what is documented of each.

use libration::Elementary;
use libration::elementary::sine64;
use libration::number::TwoFloat;

/// A function of one argument in all forms in which the tests need it.
pub(super) struct Function {
    pub(super) name: &'static str,
    pub(super) double: fn(f64) -> f64,
    pub(super) single: fn(f32) -> f32,
    pub(super) wider: fn(TwoFloat) -> TwoFloat,
    /// The correctly rounded function of CORE-MATH.
    pub(super) correct: fn(f64) -> f64,
    /// Beyond this magnitude it is undefined, or does not change.
    pub(super) largest: f64,
    /// Documented errors in ulp: of `f64`, of `f32`.
    pub(super) errors: [f64; 2],
}

macro_rules! function {
    ($name:ident, $correct:ident, $largest:expr, $errors:expr) => {
        Function {
            name: stringify!($name),
            double: |x| Elementary::$name(x),
            single: |x| Elementary::$name(x),
            wider: |x| Elementary::$name(x),
            correct: core_math::$correct,
            largest: $largest,
            errors: $errors,
        }
    };
}

/// The errors are those in the documentation of each function.
pub(super) const FUNCTIONS: [Function; 9] = [
    function!(exp, exp, 750.0, [0.62, 0.62]),
    function!(ln, log, f64::MAX, [0.67, 0.73]),
    function!(tan, tan, sine64::RANGE, [0.88, 0.501]),
    function!(asin, asin, 1.0, [0.66, 0.501]),
    function!(acos, acos, 1.0, [0.65, 0.501]),
    function!(atan, atan, f64::MAX, [0.68, 0.501]),
    function!(sinh, sinh, 712.0, [0.74, 0.501]),
    function!(cosh, cosh, 712.0, [0.70, 0.501]),
    function!(tanh, tanh, 30.0, [0.74, 0.501]),
];

/// The documented errors of `atan2`.
pub(super) const ATAN2_ERRORS: [f64; 2] = [0.68, 0.501];

/// The function of that name.
pub(super) fn function(name: &str) -> Option<&'static Function> {
    FUNCTIONS.iter().find(|function| function.name == name)
}
