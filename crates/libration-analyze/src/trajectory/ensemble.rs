//! Rows of an ensemble.

use half::{bf16, f16};
use libration::Method;
use libration::ensemble::{BatchFloat, InsufficientMemory};

use super::{EnsembleOptions, Monitor, Outcome, Request, TrajectoryError, loops};
use crate::export::{Number, Rows};

/// Trajectory steps between two checks of the monitor: half a second of the slowest kernel.
const CHUNK: u64 = 1 << 21;

/// A float type of a simulation; only native floats have ensembles and loops.
pub(super) trait EnsembleFloat: Number {
    /// Whether the processor has arithmetic of this type.
    const IS_NATIVE: bool;

    /// Checks that the ensemble of a request is supported and fits into memory.
    fn check_memory(request: &Request, ensemble: &EnsembleOptions) -> Result<(), TrajectoryError>;

    /// Simulates the ensemble of a checked request.
    fn run_ensemble(
        request: &Request,
        method: Method,
        ensemble: &EnsembleOptions,
        rows: &mut dyn Rows<Self>,
        monitor: &dyn Monitor,
    ) -> Result<Outcome, TrajectoryError>;

    /// Simulates the loops of a checked request.
    fn run_loops(
        request: &Request,
        rows: &mut dyn Rows<Self>,
        monitor: &dyn Monitor,
    ) -> Result<Outcome, TrajectoryError>;
}

macro_rules! vectors {
    ($($float:ident)*) => {$(
        impl EnsembleFloat for $float {
            const IS_NATIVE: bool = true;

            fn run_ensemble(
                request: &Request,
                method: Method,
                ensemble: &EnsembleOptions,
                rows: &mut dyn Rows<Self>,
                monitor: &dyn Monitor,
            ) -> Result<Outcome, TrajectoryError> {
                run::<$float>(request, method, ensemble, rows, monitor)
            }

            fn run_loops(
                request: &Request,
                rows: &mut dyn Rows<Self>,
                monitor: &dyn Monitor,
            ) -> Result<Outcome, TrajectoryError> {
                loops::run::<$float>(request, rows, monitor)
            }

            fn check_memory(request: &Request, ensemble: &EnsembleOptions) -> Result<(), TrajectoryError> {
                let bytes = <$float>::ensemble_bytes(request.q.len(), ensemble.count);
                // Loops have clocks, and both are built from lists of starts.
                let factor = if request.loop_option().is_some() { 4 } else { 1 };
                InsufficientMemory::check(factor * bytes).map_err(TrajectoryError::Memory)
            }
        }
    )*};
}

macro_rules! scalar_only {
    ($($float:ident)*) => {$(
        impl EnsembleFloat for $float {
            const IS_NATIVE: bool = false;

            fn run_ensemble(
                request: &Request,
                _: Method,
                ensemble: &EnsembleOptions,
                _: &mut dyn Rows<Self>,
                _: &dyn Monitor,
            ) -> Result<Outcome, TrajectoryError> {
                Self::check_memory(request, ensemble).map(|()| Outcome::Complete)
            }

            fn run_loops(
                request: &Request,
                _: &mut dyn Rows<Self>,
                _: &dyn Monitor,
            ) -> Result<Outcome, TrajectoryError> {
                Err(no_vectors(request))
            }

            fn check_memory(request: &Request, _: &EnsembleOptions) -> Result<(), TrajectoryError> {
                Err(no_vectors(request))
            }
        }
    )*};
}

vectors!(f64 f32);
scalar_only!(f16 bf16);

/// The error of an ensemble or a loop in a float type without native arithmetic.
fn no_vectors(request: &Request) -> TrajectoryError {
    TrajectoryError::Value {
        name: "float",
        value: request.float.name().to_owned(),
        allowed: "f64 or f32 for ensembles and loops".to_owned(),
    }
}

fn run<S: BatchFloat + Number>(
    request: &Request,
    method: Method,
    ensemble: &EnsembleOptions,
    rows: &mut dyn Rows<S>,
    monitor: &dyn Monitor,
) -> Result<Outcome, TrajectoryError> {
    let Request { system, dt, steps, every, .. } = *request;
    let (dimension, count) = (request.q.len(), ensemble.count);
    let coordinate = |i: usize| match i.checked_sub(dimension) {
        None => request.q.get(i),
        Some(i) => request.v.get(i),
    };
    let start = |n, i| S::from_f64(ensemble.scale(n) * coordinate(i).copied().unwrap_or(0.0));
    let mut all = S::ensemble(system, dimension, count, ensemble.execution()?, &start)?;
    let mut values = Vec::with_capacity(2 * dimension + 1);
    let at_once = (CHUNK / (count as u64).max(1)).max(1);
    loop {
        let step = all.step();
        let time = step as f64 * S::from_f64(dt).to_f64();
        if step.is_multiple_of(every) || step == steps {
            for n in 0..count {
                if monitor.should_stop() {
                    return Err(TrajectoryError::Interrupted);
                }
                values.clear();
                let planes =
                    (0..dimension).map(|i| all.q(i)).chain((0..dimension).map(|i| all.v(i)));
                values.extend(planes.flatten().filter_map(|plane| plane.get(n).copied()));
                values.extend(all.energy(n));
                rows.row(&[n as u64, step], time, &values)?;
            }
        }
        if step == steps {
            let lost = all.not_finite();
            return Ok(Outcome::of::<S>(request, &lost));
        }
        if monitor.should_stop() {
            return Err(TrajectoryError::Interrupted);
        }
        let to_next_row = (every - step % every).min(steps - step);
        all.advance(method, S::from_f64(dt), to_next_row.min(at_once));
        monitor.on_step(all.step());
    }
}
