//! The rounding of float types along an orbit.

use libration::number::TwoFloat;
use libration::simulation::SimulationError;
use libration::{Float, Method};
use libration_study::StudyError;

use super::Problem;

/// The distance of a run in floats of type `S` from the same in double-double, in the end and as a part of the largest state; none
/// where a state leaves the range of `S`.
pub(super) fn measure<S: Float>(
    problem: &Problem,
    method: Method,
    steps: u64,
    turns: u64,
) -> Result<Option<f64>, StudyError> {
    let rounded = end::<S>(problem, method, steps, turns)?;
    let exact = end::<TwoFloat>(problem, method, steps, turns)?;
    Ok(rounded.zip(exact).map(|(rounded, exact)| distance(problem, &rounded, &exact)))
}

/// The distance of a run from one with steps of half the length, both in double-double.
pub(super) fn of_step(
    problem: &Problem,
    method: Method,
    steps: u64,
    turns: u64,
) -> Result<Option<f64>, StudyError> {
    let [whole, half] =
        [steps, 2 * steps].map(|steps| end::<TwoFloat>(problem, method, steps, turns));
    Ok(whole?.zip(half?).map(|(whole, half)| distance(problem, &whole, &half)))
}

/// The last state.
fn end<S: Float>(
    problem: &Problem,
    method: Method,
    steps: u64,
    turns: u64,
) -> Result<Option<Vec<f64>>, StudyError> {
    let start: Vec<S> = problem.start.iter().map(|&x| S::from_f64(x)).collect();
    // With its own rounding a type may not even hold the time step.
    match problem.run(method, &start, problem.step(steps), steps * turns, &mut |_, _| {}) {
        Ok(end) => Ok(Some(end.into_iter().map(Float::to_f64).collect())),
        Err(SimulationError::NotFinite { .. } | SimulationError::TimeStep { .. }) => Ok(None),
        Err(error) => Err(error.into()),
    }
}

fn distance(problem: &Problem, a: &[f64], b: &[f64]) -> f64 {
    let largest = |of: &dyn Fn(usize) -> f64| {
        problem.states.iter().map(|state| of(state.place).abs()).fold(0.0, f64::max)
    };
    largest(&|i| a[i] - b[i]) / largest(&|i| b[i])
}
