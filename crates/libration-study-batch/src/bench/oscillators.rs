//! The shipped kernels as contestants.

use std::hint::black_box;

use libration::ensemble::{AnyEnsemble, EnsembleError, Execution};
use libration::system::Oscillator;
use libration::{AnySystem, Method};

use super::{Bench, Contestant, Task};

/// The ensemble of a task.
///
/// # Errors
/// If the memory is refused.
pub(crate) fn oscillators<T: Bench>(
    task: Task,
    execution: &Execution,
) -> Result<AnyEnsemble<T>, EnsembleError> {
    let system = AnySystem::Oscillator(Oscillator { omega2: task.omega2 });
    let start = |n: usize, i: usize| T::from_f64(task.start(n)[i]);
    AnyEnsemble::of_system(system, 1, task.count, execution.clone(), start)
}

/// A task under `method`, so many steps a pass: steps a second of all trajectories together.
///
/// # Errors
/// If the memory is refused.
pub(crate) fn stepping<T: Bench>(
    method: Method,
    task: Task,
    steps: u64,
    execution: &Execution,
) -> Result<Contestant<'static>, EnsembleError> {
    let mut ensemble = oscillators::<T>(task, execution)?;
    let dt = T::from_f64(task.dt);
    Ok(Contestant::new(task.count as f64 * steps as f64, move |times| {
        for _ in 0..times {
            ensemble.advance(method, dt, steps);
        }
        black_box(ensemble.q(0));
    }))
}
