//! The rounding of float types along an orbit.

use libration::number::TwoFloat;
use libration::simulation::SimulationError;
use libration::{Float, Method};
use libration_study::StudyError;

use super::Problem;

/// The distance of a run in floats of type `S` from the same in double-double in the end, each state as a part of its largest value in
/// the run; none where a state leaves the range of `S`.
pub(super) fn measure<S: Float>(
    problem: &Problem,
    method: Method,
    steps: u64,
    turns: u64,
) -> Result<Option<f64>, StudyError> {
    let rounded = run::<S>(problem, method, steps, turns)?;
    let exact = run::<TwoFloat>(problem, method, steps, turns)?;
    Ok(rounded.zip(exact).map(|(rounded, exact)| rounded.distance(&exact)))
}

/// The distance of a run from one with steps of half the length, both in double-double.
pub(super) fn of_step(
    problem: &Problem,
    method: Method,
    steps: u64,
    turns: u64,
) -> Result<Option<f64>, StudyError> {
    let [whole, half] =
        [steps, 2 * steps].map(|steps| run::<TwoFloat>(problem, method, steps, turns));
    Ok(whole?.zip(half?).map(|(whole, half)| whole.distance(&half)))
}

/// The states under study after a run, and the largest value of each in it.
struct Run {
    end: Vec<f64>,
    largest: Vec<f64>,
}

impl Run {
    fn distance(&self, exact: &Run) -> f64 {
        let pairs = self.end.iter().zip(&exact.end).zip(&exact.largest);
        let parts = pairs.filter(|(_, largest)| **largest > 0.0);
        parts.map(|((a, b), largest)| (a - b).abs() / largest).fold(0.0, f64::max)
    }
}

fn run<S: Float>(
    problem: &Problem,
    method: Method,
    steps: u64,
    turns: u64,
) -> Result<Option<Run>, StudyError> {
    let start: Vec<S> = problem.start.iter().map(|&x| S::from_f64(x)).collect();
    let studied = |state: &[S]| -> Vec<f64> {
        problem.states.iter().map(|studied| state[studied.place].to_f64()).collect()
    };
    let mut largest = vec![0.0_f64; problem.states.len()];
    let mut watch = |_: u64, state: &[S]| {
        largest.iter_mut().zip(studied(state)).for_each(|(most, x)| *most = most.max(x.abs()));
    };
    // With its own rounding a type may not even hold the time step.
    match problem.run(method, &start, problem.step(steps), steps * turns, &mut watch) {
        Ok(end) => Ok(Some(Run { end: studied(&end), largest })),
        Err(SimulationError::NotFinite { .. } | SimulationError::TimeStep { .. }) => Ok(None),
        Err(error) => Err(error.into()),
    }
}
