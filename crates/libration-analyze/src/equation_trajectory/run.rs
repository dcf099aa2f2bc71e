//! Rows of a system by equations.

use libration::equations::StepProgram;

use super::EquationRequest;
use crate::export::{Number, Rows};
use crate::motion::undefined_function;
use crate::newton_residual::{NewtonCheck, refined};
use crate::trajectory::{
    Divergence, EnsembleFloat, EnsembleOptions, EnsembleRun, Monitor, Outcome, TrajectoryError,
};

/// Steps between two checks of the monitor.
const CHUNK: u64 = 1 << 12;

/// Simulates the ensemble of a checked request in the float type `S`.
pub(super) fn run_ensemble<S: EnsembleFloat>(
    request: &EquationRequest,
    ensemble: &EnsembleOptions,
    rows: &mut dyn Rows<S>,
    monitor: &dyn Monitor,
) -> Result<Outcome, TrajectoryError> {
    let EquationRequest { system, method, dt, steps, every, .. } = request;
    let start: Vec<f64> = system.q.iter().chain(&system.v).copied().collect();
    let kept: Vec<usize> = system.states.iter().map(|state| state.place).collect();
    // The velocity of time is 1 for all.
    let scale = |n, i| if kept.contains(&i) { ensemble.scale(n) } else { 1.0 };
    let start = |n: usize, i: usize| scale(n, i) * start[i];
    let mut all = S::equation_ensemble(system.equations.dynamics(), &start, ensemble)?;
    let run = EnsembleRun { method: *method, dt: *dt, steps: *steps, every: *every, kept: &kept };
    let (lost, residual) = run.record(&mut *all, system.equations.dynamics(), rows, monitor)?;
    Ok(Outcome::of_ensemble(&lost, || None).with_residual(residual))
}

/// Simulates a checked request in the float type `S`.
pub(super) fn run<S: Number>(
    request: &EquationRequest,
    rows: &mut dyn Rows<S>,
    monitor: &dyn Monitor,
) -> Result<Outcome, TrajectoryError> {
    let EquationRequest { system, steps, every, .. } = request;
    let equations = &system.equations;
    let program = StepProgram::of(request.method, equations.dynamics());
    let refined = refined(request.method, equations.dynamics());
    let mut step_of = program.program().on::<S>();
    let mut energy_of = equations.dynamics().energy().map(|energy| energy.on::<S>());
    let d = equations.degrees().len();
    let kept: Vec<usize> = system.states.iter().map(|state| state.place).collect();
    let mut check = refined.as_ref().map(|refined| NewtonCheck::new(refined, kept.clone()));
    let dt = S::from_f64(request.dt);
    // Positions, velocities, inputs, which are zero, and the time step.
    let mut inputs: Vec<S> = system.q.iter().chain(&system.v).map(|&x| S::from_f64(x)).collect();
    inputs.resize(2 * d + equations.inputs().len(), S::zero());
    inputs.push(dt);
    let (mut values, mut next) = (Vec::with_capacity(2 * d + 1), Vec::with_capacity(2 * d));
    let mut step = 0;
    loop {
        let time = step as f64 * dt.to_f64();
        if step % every == 0 || step == *steps {
            values.clear();
            values.extend(kept.iter().map(|&place| inputs[place]));
            values.extend(energy_of.iter_mut().flat_map(|energy| energy.run(&inputs)));
            rows.row(&[step], time, &values)?;
        }
        if step == *steps {
            return Ok(Outcome::Complete.with_residual(check.and_then(|check| check.found())));
        }
        if step % CHUNK == 0 {
            if monitor.should_stop() {
                return Err(TrajectoryError::Interrupted);
            }
            monitor.on_step(step);
        }
        next.clear();
        next.extend(step_of.run(&inputs));
        step += 1;
        if !next.iter().all(|x| x.is_finite()) {
            let state: Vec<f64> = inputs.iter().map(|x| x.to_f64()).collect();
            let why = undefined_function(&program, &state[..state.len() - 1], dt.to_f64());
            let reason = "the state stopped being finite".to_owned();
            let reason = why.map_or(reason.clone(), |why| format!("{reason}: {why}"));
            let reason = reason.trim_end_matches(',').to_owned();
            let t = step as f64 * dt.to_f64();
            let outcome = Outcome::Diverged(Divergence { step, t, reason, newton_residual: None });
            return Ok(outcome.with_residual(check.and_then(|check| check.found())));
        }
        if let Some(check) = &mut check {
            check.observe(&inputs, &next, step);
        }
        inputs[..2 * d].copy_from_slice(&next);
    }
}
