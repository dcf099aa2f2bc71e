//! The rows of an ensemble.

use half::{bf16, f16};
use libration::Method;
use libration::ensemble::{BatchFloat, InsufficientMemory};

use super::{Copies, Ending, Request, TrajectoryError, Watch, loops};
use crate::export::{Number, Rows};

/// Trajectory steps between two looks at whether to stop: half a second of the slowest kernel.
const CHUNK: u64 = 1 << 21;

/// A float type in which many trajectories may be asked for.
pub(super) trait Many: Number {
    /// Whether the processor computes in it.
    const WIDE: bool;

    /// Whether the copies of a request can be had, before anything is written.
    fn admits(request: &Request, copies: &Copies) -> Result<(), TrajectoryError>;

    /// Simulates the copies of a request that has been checked.
    fn many(
        request: &Request,
        method: Method,
        copies: &Copies,
        rows: &mut dyn Rows<Self>,
        watch: &dyn Watch,
    ) -> Result<Ending, TrajectoryError>;

    /// Simulates the loops of a request that has been checked.
    fn loops(
        request: &Request,
        rows: &mut dyn Rows<Self>,
        watch: &dyn Watch,
    ) -> Result<Ending, TrajectoryError>;
}

macro_rules! vectors {
    ($($float:ident)*) => {$(
        impl Many for $float {
            const WIDE: bool = true;

            fn many(
                request: &Request,
                method: Method,
                copies: &Copies,
                rows: &mut dyn Rows<Self>,
                watch: &dyn Watch,
            ) -> Result<Ending, TrajectoryError> {
                run::<$float>(request, method, copies, rows, watch)
            }

            fn loops(
                request: &Request,
                rows: &mut dyn Rows<Self>,
                watch: &dyn Watch,
            ) -> Result<Ending, TrajectoryError> {
                loops::run::<$float>(request, rows, watch)
            }

            fn admits(request: &Request, copies: &Copies) -> Result<(), TrajectoryError> {
                let bytes = <$float>::ensemble_bytes(request.q.len(), copies.count);
                // Loops have clocks, and both are made of lists of starts.
                let alike = if request.looped().is_some() { 4 } else { 1 };
                InsufficientMemory::check(alike * bytes).map_err(TrajectoryError::Memory)
            }
        }
    )*};
}

macro_rules! scalar_only {
    ($($float:ident)*) => {$(
        impl Many for $float {
            const WIDE: bool = false;

            fn many(
                request: &Request,
                _: Method,
                copies: &Copies,
                _: &mut dyn Rows<Self>,
                _: &dyn Watch,
            ) -> Result<Ending, TrajectoryError> {
                Self::admits(request, copies).map(|()| Ending::Whole)
            }

            fn loops(
                request: &Request,
                _: &mut dyn Rows<Self>,
                _: &dyn Watch,
            ) -> Result<Ending, TrajectoryError> {
                Err(no_vectors(request))
            }

            fn admits(request: &Request, _: &Copies) -> Result<(), TrajectoryError> {
                Err(no_vectors(request))
            }
        }
    )*};
}

vectors!(f64 f32);
scalar_only!(f16 bf16);

/// That there are ensembles of the processor's floats only.
fn no_vectors(request: &Request) -> TrajectoryError {
    TrajectoryError::Value {
        name: "float",
        value: request.float.name().to_owned(),
        allowed: "f64 or f32 where there are many trajectories, or loops".to_owned(),
    }
}

fn run<S: BatchFloat + Number>(
    request: &Request,
    method: Method,
    copies: &Copies,
    rows: &mut dyn Rows<S>,
    watch: &dyn Watch,
) -> Result<Ending, TrajectoryError> {
    let Request { system, dt, steps, every, .. } = *request;
    let (dimension, count) = (request.q.len(), copies.count);
    let coordinate = |i: usize| match i.checked_sub(dimension) {
        None => request.q.get(i),
        Some(i) => request.v.get(i),
    };
    let start = |n, i| S::from_f64(copies.scale(n) * coordinate(i).copied().unwrap_or(0.0));
    let mut all = S::ensemble(system, dimension, count, copies.execution()?, &start)?;
    let mut values = Vec::with_capacity(2 * dimension + 1);
    let at_once = (CHUNK / (count as u64).max(1)).max(1);
    loop {
        let step = all.step();
        let time = step as f64 * S::from_f64(dt).to_f64();
        if step.is_multiple_of(every) || step == steps {
            for n in 0..count {
                if watch.stops() {
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
            return Ok(Ending::of::<S>(request, &lost));
        }
        if watch.stops() {
            return Err(TrajectoryError::Interrupted);
        }
        let to_next_row = (every - step % every).min(steps - step);
        all.advance(method, S::from_f64(dt), to_next_row.min(at_once));
        watch.reached(all.step());
    }
}
