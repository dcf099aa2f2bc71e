//! The function without a value that ends a run.

use libration::equations::StepProgram;

/// The function that has no value for a finite argument in a step from positions, velocities and inputs, in words; none if the numbers of
/// the step become too large.
pub(crate) fn undefined_function(step: &StepProgram, from: &[f64], dt: f64) -> Option<String> {
    let inputs = [from, &[dt]].concat();
    let (function, argument) = step.program().undefined_function(&inputs)?;
    let why = match function.name() {
        "sin" | "cos" | "tan" => "the angle is beyond the range of this function here",
        _ => "it is not defined there",
    };
    Some(format!("`{}` has no value at {argument:.4e}, as {why},", function.name()))
}
