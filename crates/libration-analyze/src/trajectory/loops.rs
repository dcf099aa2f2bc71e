//! The rows of loops: trajectories under feedback, with clocks and commands that are not ideal.

use bytemuck::Pod;
use libration::control::clock::{Jittered, Recorded, Skewed};
use libration::control::controller::StateFeedback;
use libration::control::{Jitter, Latency, Schedule};
use libration::ensemble::{All, Loops, Setup};
use libration::integrator::SymplecticEuler;
use libration::system::{DynSystem, Oscillator};
use libration::{Float, Hamiltonian, Integrator, Model, State, System, with_system};

use super::run::exact;
use super::{Copies, Ending, Request, TrajectoryError, Watch};
use crate::analyze::Stepping;
use crate::export::{Number, Rows};

/// Steps of trajectories between two looks at whether to stop: a tenth of a second where there is one.
const CHUNK: u64 = 1 << 18;

/// Every clock that can be asked for is a clock with a rate of its own whose steps, which may have been recorded, jitter.
type Clocks<'a> = (Skewed, (Recorded<'a>, Jittered<Jitter>));

/// The record of a clock of which there is none.
const EVEN: [f64; 1] = [1.0];

/// Most degrees of freedom: kernels for more would take long to compile.
pub(super) const MOST_DIMENSIONS: usize = 2;

/// Simulates what is asked, which has been checked.
pub(super) fn run<S: Float + Pod + Number>(
    request: &Request,
    rows: &mut dyn Rows<S>,
    watch: &dyn Watch,
) -> Result<Ending, TrajectoryError> {
    let dimension = request.q.len();
    let wrong = || Err(request.system.entry().wrong_dimension(dimension).into());
    with_system!(
        request.system,
        dimension,
        |model, D| {
            if const { D <= MOST_DIMENSIONS } {
                on_model::<S, D, _>(&model, request, rows, watch)
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
    watch: &dyn Watch,
) -> Result<Ending, TrajectoryError> {
    let system = model.on::<S>();
    let energy = |state: &State<S, D>| system.energy(state);
    // The model, which threads can share, says it anew for every step.
    let acceleration = |state: &State<S, D>| model.on::<S>().acceleration(state);
    let chosen = DynSystem(&acceleration);
    match request.stepping {
        Stepping::Method(method) => simulated(chosen, method, &energy, request, rows, watch),
        Stepping::Exact => simulated(chosen, exact(model, request)?, &energy, request, rows, watch),
    }
}

/// The loops, and beside them what only moves with time: their clocks.
fn simulated<S: Float + Pod + Number, const D: usize>(
    system: DynSystem<'_, S, D>,
    integrator: impl Integrator,
    energy: &dyn Fn(&State<S, D>) -> S,
    request: &Request,
    rows: &mut dyn Rows<S>,
    watch: &dyn Watch,
) -> Result<Ending, TrajectoryError> {
    let Request { dt, steps, every, timing, record, seed, .. } = request;
    let one = Copies { count: 1, spread: 0.0, threads: 1, instructions: None };
    let copies = request.copies.unwrap_or(one);
    let (count, execution) = (copies.count, copies.execution()?);
    let dt = S::from_f64(*dt);
    let none = Jitter::Uniform(0.0);
    let uneven = timing.jitter.is_some() || timing.skew.is_some() || record.is_some();
    let recorded = record.as_deref().map_or(Recorded::repeated(&EVEN), Recorded::once);
    let jittered = Jittered(timing.jitter.unwrap_or(none));
    let clocks: Clocks<'_> = (Skewed(timing.skew.unwrap_or(none)), (recorded, jittered));
    let gains = timing.feedback.unwrap_or_default().per_mass(request.actuation.mass());
    let latency = timing.latency_of(dt.to_f64()).map_err(|steps| late(request, steps))?;
    let setup = Setup::new(All(system), integrator)
        .controller(StateFeedback::<D>::to_origin(gains))
        .clock(clocks)
        .delay(Schedule::late(latency));
    let starts: Vec<State<S, D>> = (0..count).map(|n| start(request, copies.scale(n))).collect();
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
                if watch.stops() {
                    return Err(TrajectoryError::Interrupted);
                }
                let (Some(state), Some(&shown)) = (all.state(n), time.trajectories().q(0).get(n))
                else {
                    continue;
                };
                // What adds up steps that are all alike only rounds.
                let t = if uneven { shown } else { step as f64 * dt.to_f64() };
                values.clear();
                values.extend(state.coordinates());
                values.push(energy(&state));
                let index = [n as u64, step];
                let whole = if request.copies.is_some() { &index[..] } else { &index[1..] };
                rows.row(whole, t, &values)?;
            }
        }
        if step == *steps {
            let lost: Vec<usize> = all.trajectories().not_finite().collect();
            return Ok(Ending::of::<S>(request, &lost));
        }
        if watch.stops() {
            return Err(TrajectoryError::Interrupted);
        }
        let to_next_row = (every - step % every).min(steps - step).min(at_once);
        all.advance(to_next_row)?;
        time.advance(to_next_row)?;
        watch.reached(all.step());
    }
}

/// The start, so many times as far out.
fn start<S: Float, const D: usize>(request: &Request, scale: f64) -> State<S, D> {
    let coordinate = |x: &[f64], i: usize| x.get(i).map_or(S::zero(), |x| S::from_f64(scale * x));
    State {
        q: core::array::from_fn(|i| coordinate(&request.q, i)),
        v: core::array::from_fn(|i| coordinate(&request.v, i)),
    }
}

/// What is wrong with a latency.
pub(super) fn late(request: &Request, steps: f64) -> TrajectoryError {
    TrajectoryError::Value {
        name: "latency",
        value: format!("{steps:?} steps of {:?} s", request.dt),
        allowed: format!("at least 0 and at most {} steps", Latency::MOST_STEPS),
    }
}
