//! A step of a system of the catalogue as a matrix, and the energy that steps lose.

use std::sync::atomic::{AtomicBool, Ordering};

use libration::analysis::{DriftForecast, Linearisation, QuadraticForm};
use libration::equations::{Dynamics, StepProgram};
use libration::number::Wide;
use libration::{AnyMethod, State, Trajectory};

use super::step_matrix::is_undefined;
use super::{AnalyzeError, Drift, Request, Stepping, regular_starts};
use crate::newton_residual::{self, NewtonResidual};

/// The results that depend on the integrator.
pub(super) struct LinearStep {
    pub(super) linear: Linearisation,
    pub(super) evaluations: u64,
    /// The largest drift of the energy; none if it begins at zero.
    pub(super) drift: Option<Drift>,
}

impl LinearStep {
    /// The step of the request, by its program.
    pub(super) fn new(request: &Request, stop: &AtomicBool) -> Result<Self, AnalyzeError> {
        let dynamics = request.system.equations.dynamics();
        let start = request.system.start();
        let Some(method) = request.stepping.any_method() else {
            let linear = Linearisation::exact(dynamics, &start, request.dt);
            let drift = exact_drift(dynamics, &linear, request);
            return Ok(LinearStep { linear, evaluations: 0, drift });
        };
        let program = StepProgram::of(method, dynamics);
        let linear = Linearisation::new(&program, dynamics, &start, request.dt);
        if is_undefined(&linear.step) {
            let (q, v) = (request.system.q.clone(), request.system.v.clone());
            return Err(AnalyzeError::Singular {
                allowed: regular_starts(request.compiled()),
                q,
                v,
            });
        }
        let drift = match request.system.is_linear() {
            true => exact_drift(dynamics, &linear, request),
            false => simulated_drift(method, dynamics, &start, request, stop)?,
        };
        Ok(LinearStep { linear, evaluations: program.evaluations() as u64, drift })
    }
}

/// The residual that Newton steps leave in the motion of a nonlinear system; none without an iteration.
pub(super) fn newton_residual(request: &Request, stop: &AtomicBool) -> Option<NewtonResidual> {
    let Stepping::Implicit(method) = request.stepping else { return None };
    if request.system.is_linear() {
        return None;
    }
    let start = request.system.start();
    let run = (request.dt, request.steps);
    let dynamics = request.system.equations.dynamics();
    let places = request.system.states.iter().map(|state| state.place).collect();
    newton_residual::of_run(method.into(), dynamics, &start, places, run, stop)
}

/// The drift of a linear system, whose degrees of freedom all move alike.
fn exact_drift(dynamics: &Dynamics, linear: &Linearisation, request: &Request) -> Option<Drift> {
    let degrees = dynamics.degrees();
    let program = dynamics.energy()?;
    let energy = QuadraticForm::of(|state: &State<Wide, 1>| {
        let mut all = vec![Wide::ZERO; 2 * degrees];
        (all[0], all[degrees]) = (state.q[0], state.v[0]);
        program.on().run(&all).next().unwrap_or(Wide::ZERO)
    });
    let starts =
        request.system.q.iter().zip(&request.system.v).map(|(&q, &v)| State { q: [q], v: [v] });
    let starts: Vec<State<f64, 1>> = starts.collect();
    let step = linear.step.decoupled()?.into_iter().next()?;
    DriftForecast::of_orbits(&energy, &step, &starts, request.steps).map(Drift::from)
}

/// Steps between two checks of the stop flag.
const PIECE: u64 = 1 << 16;

/// The drift of a nonlinear system, simulated in `f64`.
fn simulated_drift(
    method: AnyMethod,
    dynamics: &Dynamics,
    start: &[f64],
    request: &Request,
    stop: &AtomicBool,
) -> Result<Option<Drift>, AnalyzeError> {
    let Some(program) = dynamics.energy() else { return Ok(None) };
    let mut energy = program.on::<f64>();
    let mut energy = |state: &[f64]| energy.run(state).next().unwrap_or(f64::NAN);
    let mut trajectory = Trajectory::new(method, dynamics, start, request.dt);
    let initial = energy(start);
    let (mut largest, mut at_step, mut stopped) = (0.0, 0, None);
    for step in 1..=request.steps {
        if step % PIECE == 0 && stop.load(Ordering::Relaxed) {
            return Err(AnalyzeError::Interrupted);
        }
        if !trajectory.advance(1) {
            stopped = Some(step);
            break;
        }
        let drift = ((energy(trajectory.state()) - initial) / initial.abs()).abs();
        if drift > largest || drift.is_nan() {
            (largest, at_step) = (drift, step);
        }
    }
    Ok((initial != 0.0).then(|| Drift::simulated(largest, at_step, stopped)))
}
