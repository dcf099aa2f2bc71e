//! Rows of an ensemble.

use half::{bf16, f16};
use libration::AnyMethod;
use libration::ensemble::{AnyEnsemble, BatchFloat, InsufficientMemory};
use libration::equations::{Dynamics, StepProgram};

use super::{EnsembleOptions, Monitor, Outcome, Request, TrajectoryError, loops};
use crate::export::{Number, Rows};
use crate::newton_residual::{NewtonCheck, NewtonResidual, refined};

/// Steps of a degree of freedom between two checks of the monitor: half a second of the slowest kernel.
const CHUNK: u64 = 1 << 21;

/// A float type of a simulation; only native floats have ensembles and loops.
pub(crate) trait EnsembleFloat: Number {
    /// Checks that the ensemble of a request is supported and fits into memory.
    fn check_memory(request: &Request, ensemble: &EnsembleOptions) -> Result<(), TrajectoryError> {
        // Loops have clocks, and both are built from lists of starts.
        let factor = if request.loop_option().is_some() { 4 } else { 1 };
        Self::check_ensemble(factor * request.system.q.len(), ensemble)
    }

    /// Checks that ensembles are supported, and that one with so many degrees of freedom fits into memory.
    fn check_ensemble(degrees: usize, ensemble: &EnsembleOptions) -> Result<(), TrajectoryError>;

    /// Simulates the ensemble of a checked request.
    fn run_ensemble(
        request: &Request,
        method: AnyMethod,
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
            fn run_ensemble(
                request: &Request,
                method: AnyMethod,
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

            fn check_ensemble(
                degrees: usize,
                ensemble: &EnsembleOptions,
            ) -> Result<(), TrajectoryError> {
                let bytes = AnyEnsemble::<$float>::bytes(degrees, ensemble.count);
                InsufficientMemory::check(bytes).map_err(TrajectoryError::Memory)
            }
        }
    )*};
}

macro_rules! scalar_only {
    ($($float:ident)*) => {$(
        impl EnsembleFloat for $float {
            fn run_ensemble(
                request: &Request,
                _: AnyMethod,
                ensemble: &EnsembleOptions,
                _: &mut dyn Rows<Self>,
                _: &dyn Monitor,
            ) -> Result<Outcome, TrajectoryError> {
                Self::check_memory(request, ensemble).map(|()| Outcome::Complete)
            }

            fn run_loops(
                _: &Request,
                _: &mut dyn Rows<Self>,
                _: &dyn Monitor,
            ) -> Result<Outcome, TrajectoryError> {
                Err(no_vectors::<Self>())
            }

            fn check_ensemble(_: usize, _: &EnsembleOptions) -> Result<(), TrajectoryError> {
                Err(no_vectors::<Self>())
            }
        }
    )*};
}

vectors!(f64 f32);
scalar_only!(f16 bf16);

/// The error of an ensemble or a loop in a float type without native arithmetic.
fn no_vectors<S: Number>() -> TrajectoryError {
    TrajectoryError::Value {
        name: "dtype",
        value: S::NAME.to_owned(),
        allowed: "f64 or f32 for ensembles and loops".to_owned(),
    }
}

fn run<S: BatchFloat + Number>(
    request: &Request,
    method: AnyMethod,
    ensemble: &EnsembleOptions,
    rows: &mut dyn Rows<S>,
    monitor: &dyn Monitor,
) -> Result<Outcome, TrajectoryError> {
    let Request { system, dt, steps, every, .. } = request;
    let dynamics = system.equations.dynamics();
    let first = system.initial_state();
    let kept: Vec<usize> = system.states.iter().map(|state| state.place).collect();
    // The velocity of time is 1 for all.
    let scale = |n, i| if kept.contains(&i) { ensemble.scale(n) } else { 1.0 };
    let start = |n: usize, i: usize| S::from_f64(scale(n, i) * first[i]);
    let (count, execution) = (ensemble.count, ensemble.execution()?);
    let twin = system.twin.map(|twin| twin.system);
    let mut all = AnyEnsemble::<S>::new(dynamics, twin, count, execution, start)?;
    let run = EnsembleRun { method, dt: *dt, steps: *steps, every: *every, kept: &kept };
    let (lost, residual) = run.record(&mut all, dynamics, rows, monitor)?;
    Ok(Outcome::of::<S>(request, &lost).with_residual(residual))
}

/// The steps of an ensemble, and what is kept of them.
struct EnsembleRun<'a> {
    method: AnyMethod,
    /// The time step in seconds.
    dt: f64,
    steps: u64,
    /// The interval of kept steps.
    every: u64,
    /// The coordinates that are kept, by their places among positions and velocities.
    kept: &'a [usize],
}

impl EnsembleRun<'_> {
    /// Simulates, gives the rows of kept steps, and returns the trajectories that are not finite in the end, and what iterations left in the
    /// steps after the kept ones.
    fn record<S: BatchFloat + Number>(
        &self,
        all: &mut AnyEnsemble<S>,
        dynamics: &Dynamics,
        rows: &mut dyn Rows<S>,
        monitor: &dyn Monitor,
    ) -> Result<(Vec<usize>, Option<NewtonResidual>), TrajectoryError> {
        let EnsembleRun { method, dt, steps, every, kept } = *self;
        let (count, dimension) = (all.len(), all.dimension());
        let mut values = Vec::with_capacity(kept.len() + 1);
        let refined = refined(method, dynamics);
        let own = refined.as_ref().map(|_| StepProgram::of(method, dynamics));
        let mut check = refined.as_ref().map(|step| NewtonCheck::new(step, kept.to_vec()));
        let mut step_of = own.as_ref().map(|step| step.program().on::<S>());
        let at_once = (CHUNK / (count as u64 * dimension as u64).max(1)).max(1);
        loop {
            let step = all.step();
            let time = step as f64 * S::from_f64(dt).to_f64();
            if step.is_multiple_of(every) || step == steps {
                let energies = all.energies();
                let plane = |&i: &usize| match i.checked_sub(dimension) {
                    None => all.q(i),
                    Some(i) => all.v(i),
                };
                let planes: Vec<&[S]> = kept.iter().filter_map(plane).collect();
                for n in 0..count {
                    if monitor.should_stop() {
                        return Err(TrajectoryError::Interrupted);
                    }
                    values.clear();
                    values.extend(planes.iter().map(|plane| plane[n]));
                    values.extend(energies.as_ref().map(|energies| energies[n]));
                    rows.row(&[n as u64, step], time, &values)?;
                }
            }
            if step == steps {
                return Ok((all.not_finite(), check.and_then(|check| check.found())));
            }
            if monitor.should_stop() {
                return Err(TrajectoryError::Interrupted);
            }
            // The steps of an ensemble are those of the program, bit by bit.
            if let (Some(check), Some(step_of)) = (&mut check, &mut step_of)
                && step.is_multiple_of(every)
            {
                let planes = (0..2 * dimension).filter_map(|i| match i.checked_sub(dimension) {
                    None => all.q(i),
                    Some(i) => all.v(i),
                });
                let planes: Vec<&[S]> = planes.collect();
                let mut inputs = vec![S::zero(); 2 * dimension + dynamics.inputs() + 1];
                inputs[2 * dimension + dynamics.inputs()] = S::from_f64(dt);
                for n in 0..count {
                    inputs.iter_mut().zip(&planes).for_each(|(to, plane)| *to = plane[n]);
                    let next: Vec<S> = step_of.run(&inputs).collect();
                    if next.iter().all(|x| x.is_finite()) {
                        check.begin();
                        check.observe(&inputs, &next, step + 1);
                    }
                }
            }
            let to_next_row = (every - step % every).min(steps - step);
            let (dt, steps) = (S::from_f64(dt), to_next_row.min(at_once));
            all.advance(method, dt, steps);
            monitor.on_step(all.step());
        }
    }
}
