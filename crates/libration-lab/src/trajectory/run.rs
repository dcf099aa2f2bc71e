//! From the run-time choice of system, integrator and float type to the loop that steps.

use std::sync::atomic::{AtomicBool, Ordering};

use libration::simulation::{SimulationError, Simulator};
use libration::{Hamiltonian, Integrator, Model, Scalar, State, with_method, with_system};

use super::many::Many;
use super::{Ending, Request, Stopped, TrajectoryError};
use crate::export::{Number, Rows};

/// Steps between two looks at whether to stop.
const CHUNK: u64 = 1 << 16;

/// Simulates `request`, which has been checked, in the float type `S`.
pub(super) fn run<S: Many>(
    request: &Request,
    rows: &mut dyn Rows<S>,
    stop: &AtomicBool,
) -> Result<Ending, TrajectoryError> {
    if let Some(copies) = &request.copies {
        return S::many(request, copies, rows, stop);
    }
    let dimension = request.q.len();
    with_system!(
        request.system,
        dimension,
        |model, D| on_model::<S, D, _>(&model, request, rows, stop),
        Err(request.system.entry().wrong_dimension(dimension).into()),
    )
}

fn on_model<S: Number, const D: usize, M: Model<D>>(
    model: &M,
    request: &Request,
    rows: &mut dyn Rows<S>,
    stop: &AtomicBool,
) -> Result<Ending, TrajectoryError> {
    let system = model.on::<S>();
    let coordinates = |x: &[f64]| core::array::from_fn(|i| x.get(i).map_or(S::zero(), number));
    let start = State { q: coordinates(&request.q), v: coordinates(&request.v) };
    let dt = S::from_f64(request.dt);
    with_method!(request.method, |integrator| {
        let simulator = Simulator::new(system, integrator, start, dt)?;
        advance(simulator, system, request, rows, stop)
    })
}

fn number<S: Scalar>(x: &f64) -> S {
    S::from_f64(*x)
}

/// Runs `simulator` to the end, showing `rows` the start, each `every`-th step and the last.
fn advance<S: Number, const D: usize, Sys: Hamiltonian<S, D> + Copy, I: Integrator>(
    mut simulator: Simulator<Sys, I, S, D>,
    system: Sys,
    request: &Request,
    rows: &mut dyn Rows<S>,
    stop: &AtomicBool,
) -> Result<Ending, TrajectoryError> {
    let Request { steps, every, .. } = *request;
    let mut values = Vec::with_capacity(2 * D + 1);
    let mut show = |simulator: &Simulator<Sys, I, S, D>| {
        let sample = simulator.sample();
        values.clear();
        values.extend(sample.state.coordinates());
        values.push(system.energy(&sample.state));
        rows.row(&[sample.step], sample.time, &values)
    };
    show(&simulator)?;
    let (mut step, mut shown) = (0, 0);
    while step < steps {
        if stop.load(Ordering::Relaxed) {
            return Err(TrajectoryError::Interrupted);
        }
        let to_next_row = (every - step % every).min(steps - step);
        let outcome = simulator.run(to_next_row.min(CHUNK), &mut ());
        step = simulator.sample().step;
        let ended = outcome.is_err() || step == steps;
        if step != shown && (ended || step.is_multiple_of(every)) {
            show(&simulator)?;
            shown = step;
        }
        match outcome {
            Ok(()) => {}
            Err(SimulationError::NotFinite { step, time: t }) => {
                let reason = "the state stopped being finite";
                return Ok(Ending::Stopped(Stopped { step, t, reason }));
            }
            Err(error) => return Err(error.into()),
        }
    }
    Ok(Ending::Whole)
}
