//! Implicit steps of a system of the catalogue, by their program.

use std::cell::RefCell;
use std::sync::atomic::{AtomicBool, Ordering};

use libration::analysis::Linearisation;
use libration::ensemble::dynamics_of;
use libration::equations::StepProgram;
use libration::number::{Dual, Wide};
use libration::simulation::{EnergyDrift, Observer, Sample, SimulationError};
use libration::{ImplicitMethod, Model, State, Trajectory};

use super::{AnalyzeError, Drift, PIECE, Request, Step, Stepping, check_jacobian};
use crate::newton_residual::{self, NewtonResidual};

impl<const D: usize> Step<D> {
    /// A step that solves equations. The program is the same for all number types, so that nothing is compiled for each method.
    pub(super) fn solve(
        method: ImplicitMethod,
        model: impl Model<D>,
        start: State<f64, D>,
        request: &Request,
        stop: &AtomicBool,
    ) -> Result<Self, AnalyzeError> {
        let wrong = || request.system.entry().wrong_dimension(D);
        let dynamics = dynamics_of(request.system, D).ok_or_else(wrong)?;
        let program = StepProgram::implicit(method, &dynamics);
        let run = RefCell::new(program.program().on::<Dual<Wide>>());
        let step = |state: State<Dual<Wide>, D>, h: Dual<Wide>| {
            let inputs: Vec<Dual<Wide>> = state.coordinates().chain([h]).collect();
            let mut run = run.borrow_mut();
            let end: Vec<Dual<Wide>> = run.run(&inputs).collect();
            State { q: std::array::from_fn(|i| end[i]), v: std::array::from_fn(|i| end[D + i]) }
        };
        let linear = Linearisation::of_step(model, &start, request.dt, &step);
        check_jacobian(&linear, request)?;
        let drift = match request.system.is_linear() {
            true => None,
            false => {
                let start: Vec<f64> = start.coordinates().collect();
                let mut trajectory = Trajectory::new(method.into(), &dynamics, &start, request.dt);
                simulated_drift(&mut trajectory, model, request.steps, stop)?
            }
        };
        Ok(Step { linear, evaluations: program.evaluations() as u64, drift })
    }
}

/// What the Newton steps leave in the motion of a nonlinear system; none without an iteration.
pub(super) fn residual(request: &Request, stop: &AtomicBool) -> Option<NewtonResidual> {
    let Stepping::Implicit(method) = request.stepping else { return None };
    if request.system.is_linear() {
        return None;
    }
    let dynamics = dynamics_of(request.system, request.q.len())?;
    let start: Vec<f64> = request.q.iter().chain(&request.v).copied().collect();
    let run = (request.dt, request.steps);
    newton_residual::of_run(method.into(), &dynamics, &start, (0..start.len()).collect(), run, stop)
}

/// The energy drift of a nonlinear system, simulated.
fn simulated_drift<const D: usize>(
    trajectory: &mut Trajectory<f64>,
    model: impl Model<D>,
    steps: u64,
    stop: &AtomicBool,
) -> Result<Option<Drift>, AnalyzeError> {
    let sample = |trajectory: &Trajectory<f64>| {
        let state = trajectory.state();
        let (step, time) = (trajectory.steps(), trajectory.time());
        let (q, v) = (std::array::from_fn(|i| state[i]), std::array::from_fn(|i| state[D + i]));
        Sample::<f64, D> { step, time, state: State { q, v } }
    };
    let mut drift = EnergyDrift::new(model.on::<f64>(), &sample(trajectory).state);
    let mut stopped = None;
    for step in 1..=steps {
        if step % PIECE == 0 && stop.load(Ordering::Relaxed) {
            return Err(AnalyzeError::Interrupted);
        }
        if !trajectory.advance(1) {
            stopped = Some(SimulationError::NotFinite { step, time: trajectory.time_of(step) });
            break;
        }
        drift.observe(&sample(trajectory));
    }
    Ok((drift.initial() != 0.0).then(|| Drift::simulated(&drift, stopped)))
}
