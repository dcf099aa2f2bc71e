//! A single trajectory, by the program of its step.

use libration::Trajectory;

use super::ensemble::EnsembleFloat;
use super::exact_step::exact;
use super::{Divergence, Monitor, Outcome, Request, TrajectoryError, overflow};
use crate::energy_growth::EnergyGrowth;
use crate::export::{Number, Rows};
use crate::newton_residual::{NewtonCheck, refined};

/// Steps between two checks of the monitor.
const CHUNK: u64 = 1 << 16;

/// Simulates the checked `request` in the float type `S`.
pub(super) fn run<S: EnsembleFloat>(
    request: &Request,
    rows: &mut dyn Rows<S>,
    monitor: &dyn Monitor,
) -> Result<Outcome, TrajectoryError> {
    let ensemble = request.ensemble.as_ref();
    match (ensemble, request.stepping.any_method()) {
        _ if request.loop_option().is_some() => S::run_loops(request, rows, monitor),
        (Some(_), None) => S::run_loops(request, rows, monitor),
        (Some(ensemble), Some(method)) => S::run_ensemble(request, method, ensemble, rows, monitor),
        (None, _) => run_alone(request, rows, monitor),
    }
}

fn run_alone<S: Number>(
    request: &Request,
    rows: &mut dyn Rows<S>,
    monitor: &dyn Monitor,
) -> Result<Outcome, TrajectoryError> {
    let Request { system, stepping, steps, every, .. } = request;
    let dynamics = system.equations.dynamics();
    let start: Vec<S> = system.q.iter().chain(&system.v).map(|&x| S::from_f64(x)).collect();
    let dt = S::from_f64(request.dt);
    let method = stepping.any_method();
    let mut trajectory = match method {
        Some(method) => Trajectory::new(method, dynamics, &start, dt),
        None => {
            let exact = exact(system, request.dt, request.longest())?;
            Trajectory::exact(exact, dynamics, &start, dt)
        }
    };
    let kept: Vec<usize> = system.states.iter().map(|state| state.place).collect();
    let refined = method.and_then(|method| refined(method, dynamics));
    let mut check = refined.as_ref().map(|refined| NewtonCheck::new(refined, kept.clone()));
    let mut energy_of = dynamics.energy().map(|energy| energy.on::<S>());
    let mut growth = EnergyGrowth::new(system, *steps);
    let mut values = Vec::with_capacity(kept.len() + 1);
    let mut show = |trajectory: &Trajectory<S>| {
        let state = trajectory.state();
        values.clear();
        values.extend(kept.iter().map(|&place| state[place]));
        values.extend(energy_of.iter_mut().flat_map(|energy| energy.run(state)));
        rows.row(&[trajectory.steps()], trajectory.time(), &values)
    };
    show(&trajectory)?;
    let mut shown = 0;
    let is_lost = loop {
        if monitor.should_stop() {
            return Err(TrajectoryError::Interrupted);
        }
        let step = trajectory.steps();
        if let Some(growth) = &mut growth {
            growth.observe(step, trajectory.state());
        }
        if step == *steps {
            break false;
        }
        let looked_at = growth.as_ref().map_or(*steps, |growth| growth.next_step(step));
        let next = (step - step % every).saturating_add(*every).min(looked_at);
        let count = next.min(*steps).min(step + CHUNK) - step;
        let is_finite = match &mut check {
            None => trajectory.advance(count),
            Some(check) => advance_checked(&mut trajectory, check, count),
        };
        let step = trajectory.steps();
        monitor.on_step(step);
        let is_row = !is_finite || step == *steps || step.is_multiple_of(*every);
        if is_row && step != shown {
            show(&trajectory)?;
            shown = step;
        }
        if !is_finite {
            break true;
        }
    };
    let residual = check.and_then(|check| check.found());
    if !is_lost {
        let outcome = Outcome::Complete.with_residual(residual);
        return Ok(outcome.with_energy(growth.and_then(|growth| growth.fault())));
    }
    let state: Vec<f64> = trajectory.state().iter().map(|x| x.to_f64()).collect();
    let step = trajectory.steps() + 1;
    let t = step as f64 * dt.to_f64();
    let reason = "the state stopped being finite".to_owned();
    let reason = match overflow::cause::<S>(request, Some(&state)) {
        Some(cause) => reason + ": " + &cause,
        None => reason,
    };
    let outcome = Outcome::Diverged(Divergence { step, t, reason, newton_residual: None });
    Ok(outcome.with_residual(residual))
}

/// Takes steps one by one, each compared with one that iterates further. Returns whether all states are finite.
fn advance_checked<S: Number>(
    trajectory: &mut Trajectory<S>,
    check: &mut NewtonCheck<'_, S>,
    count: u64,
) -> bool {
    (0..count).all(|_| {
        let before = trajectory.inputs();
        let is_finite = trajectory.advance(1);
        if is_finite {
            check.observe(&before, trajectory.state(), trajectory.steps());
        }
        is_finite
    })
}
