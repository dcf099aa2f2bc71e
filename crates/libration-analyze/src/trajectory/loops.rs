//! Rows of control loops with latency, jitter, skew and recorded clocks.

use bytemuck::Pod;
use libration::control::clock::{Jittered, Recorded, Skewed};
use libration::control::controller::StateFeedback;
use libration::control::{Jitter, Schedule};
use libration::ensemble::{All, Loops, Setup};
use libration::integrator::SymplecticEuler;
use libration::system::{DynSystem, Oscillator};
use libration::{Float, Hamiltonian, Integrator, Model, State, System, with_system};
use libration_settings::equations::Twin;

use super::error::value_error;
use super::exact_step::exact;
use super::request::MOST_DIMENSIONS;
use super::{EnsembleOptions, Monitor, Outcome, Request, TrajectoryError};
use crate::Stepping;
use crate::export::{Number, Rows};

/// Trajectory steps between two checks of the monitor: a tenth of a second for one trajectory.
const CHUNK: u64 = 1 << 18;

/// The clocks of all requests: a rate per trajectory, recorded steps, and jitter.
type Clocks<'a> = (Skewed, (Recorded<'a>, Jittered<Jitter>));

/// The record of an ideal clock.
const EVEN: [f64; 1] = [1.0];

/// Simulates the loops of a checked request.
pub(super) fn run<S: Float + Pod + Number>(
    request: &Request,
    rows: &mut dyn Rows<S>,
    monitor: &dyn Monitor,
) -> Result<Outcome, TrajectoryError> {
    let dimension = request.system.q.len();
    let Some(Twin { system, .. }) = request.system.twin else {
        return Err(value_error("system", &request.system.name, "a system of the catalogue"));
    };
    let wrong = || Err(system.entry().wrong_dimension(dimension).into());
    with_system!(
        system,
        dimension,
        |model, D| {
            if const { D <= MOST_DIMENSIONS } {
                on_model::<S, D, _>(&model, request, rows, monitor)
            } else {
                wrong()
            }
        },
        wrong()
    )
}

fn on_model<S: Float + Pod + Number, const D: usize, M: Model<D>>(
    model: &M,
    request: &Request,
    rows: &mut dyn Rows<S>,
    monitor: &dyn Monitor,
) -> Result<Outcome, TrajectoryError> {
    let system = model.on::<S>();
    let energy = |state: &State<S, D>| system.energy(state);
    // The model is converted per step because it can be shared between threads.
    let acceleration = |state: &State<S, D>| model.on::<S>().acceleration(state);
    let chosen = DynSystem(&acceleration);
    match request.stepping {
        Stepping::Method(method) => simulated(chosen, method, &energy, request, rows, monitor),
        // Implicit steps have been refused.
        Stepping::Implicit(_) | Stepping::Exact => simulated(
            chosen,
            exact(&request.system, request.dt, request.longest())?,
            &energy,
            request,
            rows,
            monitor,
        ),
    }
}

/// Simulates the loops, and an ensemble with velocity 1 whose position is the time of each clock.
fn simulated<S: Float + Pod + Number, const D: usize>(
    system: DynSystem<'_, S, D>,
    integrator: impl Integrator,
    energy: &dyn Fn(&State<S, D>) -> S,
    request: &Request,
    rows: &mut dyn Rows<S>,
    monitor: &dyn Monitor,
) -> Result<Outcome, TrajectoryError> {
    let Request { dt, steps, every, timing, record, seed, .. } = request;
    let one = EnsembleOptions { count: 1, spread: 0.0, threads: 1, instructions: None };
    let ensemble = request.ensemble.unwrap_or(one);
    let (count, execution) = (ensemble.count, ensemble.execution()?);
    let dt = S::from_f64(*dt);
    let none = Jitter::Uniform(0.0);
    let uneven = timing.jitter.is_some() || timing.skew.is_some() || record.is_some();
    let recorded = record.as_deref().map_or(Recorded::repeated(&EVEN), Recorded::once);
    let jittered = Jittered(timing.jitter.unwrap_or(none));
    let clocks: Clocks<'_> = (Skewed(timing.skew.unwrap_or(none)), (recorded, jittered));
    let mass = request.system.twin.map_or(1.0, |twin| twin.actuation.mass());
    let gains = timing.feedback.unwrap_or_default().per_mass(mass);
    let kept: Vec<usize> = request.system.states.iter().map(|state| state.place).collect();
    let latency = timing
        .latency_of(dt.to_f64())
        .map_err(|steps| TrajectoryError::latency(steps, request.dt))?;
    let setup = Setup::new(All(system), integrator)
        .controller(StateFeedback::<D>::to_origin(gains))
        .clock(clocks)
        .delay(Schedule::late(latency));
    let starts: Vec<State<S, D>> = (0..count).map(|n| start(request, ensemble.scale(n))).collect();
    let mut all = Loops::new(setup, dt, *seed, [S::zero(); D], &starts, execution.clone())?;
    let time = Setup::new(All(Oscillator { omega2: 0.0 }), SymplecticEuler).clock(clocks);
    let zero = vec![State { q: [0.0], v: [1.0] }; count];
    let mut time = Loops::new(time, dt.to_f64(), *seed, [0.0], &zero, execution)?;

    let mut values = Vec::with_capacity(2 * D + 1);
    let at_once = (CHUNK / (count as u64).max(1)).max(1);
    loop {
        let step = all.step();
        if step.is_multiple_of(*every) || step == *steps {
            for n in 0..count {
                if monitor.should_stop() {
                    return Err(TrajectoryError::Interrupted);
                }
                let (Some(state), Some(&shown)) = (all.state(n), time.trajectories().q(0).get(n))
                else {
                    continue;
                };
                // With even steps the sum would only add rounding.
                let t = if uneven { shown } else { step as f64 * dt.to_f64() };
                values.clear();
                let coordinates: Vec<S> = state.coordinates().collect();
                values.extend(kept.iter().map(|&place| coordinates[place]));
                values.push(energy(&state));
                let index = [n as u64, step];
                let whole = if request.ensemble.is_some() { &index[..] } else { &index[1..] };
                rows.row(whole, t, &values)?;
            }
        }
        if step == *steps {
            let lost: Vec<usize> = all.trajectories().not_finite().collect();
            return Ok(Outcome::of::<S>(request, &lost));
        }
        if monitor.should_stop() {
            return Err(TrajectoryError::Interrupted);
        }
        let to_next_row = (every - step % every).min(steps - step).min(at_once);
        all.advance(to_next_row)?;
        time.advance(to_next_row)?;
        monitor.on_step(all.step());
    }
}

/// The start of the request times `scale`.
fn start<S: Float, const D: usize>(request: &Request, scale: f64) -> State<S, D> {
    let coordinate = |x: &[f64], i: usize| x.get(i).map_or(S::zero(), |x| S::from_f64(scale * x));
    State {
        q: core::array::from_fn(|i| coordinate(&request.system.q, i)),
        v: core::array::from_fn(|i| coordinate(&request.system.v, i)),
    }
}
