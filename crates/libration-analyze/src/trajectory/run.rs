//! From the run-time choice of system, integrator and float type to the loop that steps.

use libration::integrator::Exact;
use libration::simulation::{Sample, SimulationError, Simulator};
use libration::system::DynSystem;
use libration::{
    Float, Hamiltonian, Integrator, Model, Scalar, State, System, with_method, with_system,
};

use super::many::Many;
use super::{Ending, Request, Stopped, TrajectoryError, Watch, overflow};
use crate::analyze::Stepping;
use crate::export::{Number, Rows};

/// Steps between two looks at whether to stop.
const CHUNK: u64 = 1 << 16;

/// Simulates `request`, which has been checked, in the float type `S`.
pub(super) fn run<S: Many>(
    request: &Request,
    rows: &mut dyn Rows<S>,
    watch: &dyn Watch,
) -> Result<Ending, TrajectoryError> {
    if request.looped().is_some() {
        return S::loops(request, rows, watch);
    }
    match (request.copies, request.stepping) {
        (None, _) => {}
        (Some(copies), Stepping::Method(method)) => {
            return S::many(request, method, &copies, rows, watch);
        }
        (Some(_), Stepping::Exact) => return S::loops(request, rows, watch),
    }
    let dimension = request.q.len();
    with_system!(
        request.system,
        dimension,
        |model, D| on_model::<S, D, _>(&model, request, rows, watch),
        Err(request.system.entry().wrong_dimension(dimension).into()),
    )
}

fn on_model<S: Many, const D: usize, M: Model<D>>(
    model: &M,
    request: &Request,
    rows: &mut dyn Rows<S>,
    watch: &dyn Watch,
) -> Result<Ending, TrajectoryError> {
    let system = model.on::<S>();
    let coordinates = |x: &[f64]| core::array::from_fn(|i| x.get(i).map_or(S::zero(), number));
    let start = State { q: coordinates(&request.q), v: coordinates(&request.v) };
    let dt = S::from_f64(request.dt);
    let energy = |state: &State<S, D>| system.energy(state);
    // The model, which threads can share, says it anew for every step.
    let acceleration = |state: &State<S, D>| model.on::<S>().acceleration(state);
    let chosen = DynSystem(&acceleration);
    // A loop of its own for each method, where it is worth its compilation.
    let mut simulation: Box<dyn Simulation<S, D> + '_> = match request.stepping {
        Stepping::Method(method) if const { S::WIDE && D <= 2 } => {
            with_method!(method, |integrator| {
                Box::new(Simulator::new(system, integrator, start, dt)?)
            })
        }
        Stepping::Method(method) => Box::new(Simulator::new(chosen, method, start, dt)?),
        Stepping::Exact => Box::new(Simulator::new(system, exact(model, request)?, start, dt)?),
    };
    advance(&mut *simulation, &energy, request, rows, watch)
}

/// Exact steps of a request.
pub(super) fn exact<const D: usize>(
    model: &impl Model<D>,
    request: &Request,
) -> Result<Exact, TrajectoryError> {
    // Made for the longest step of all.
    let longest = request.longest();
    Exact::new(*model, longest * request.dt).ok_or_else(|| {
        let most = Exact::MOST_ANGLE / Exact::angle(*model, longest).unwrap_or(f64::NAN);
        let (value, turned) = (format!("{:?}", request.dt), Exact::MOST_ANGLE);
        let allowed =
            format!("at most {most:?}, where the longest exact step turns by {turned} radians");
        TrajectoryError::Value { name: "dt", value, allowed }
    })
}

fn number<S: Scalar>(x: &f64) -> S {
    S::from_f64(*x)
}

/// What the loop over rows asks of a simulator: so asked, it is compiled for each float type and
/// dimension, and not for each simulator of the catalogue.
trait Simulation<S, const D: usize> {
    fn run(&mut self, steps: u64) -> Result<(), SimulationError>;
    fn sample(&self) -> Sample<S, D>;
}

impl<Sys, I, S, const D: usize> Simulation<S, D> for Simulator<Sys, I, S, D>
where
    Sys: System<S, D> + Copy,
    I: Integrator,
    S: Float,
{
    fn run(&mut self, steps: u64) -> Result<(), SimulationError> {
        Simulator::run(self, steps, &mut ())
    }

    fn sample(&self) -> Sample<S, D> {
        Simulator::sample(self)
    }
}

/// Runs `simulation` to the end, showing `rows` the start, each `every`-th step and the last.
fn advance<S: Number, const D: usize>(
    simulation: &mut dyn Simulation<S, D>,
    energy: &dyn Fn(&State<S, D>) -> S,
    request: &Request,
    rows: &mut dyn Rows<S>,
    watch: &dyn Watch,
) -> Result<Ending, TrajectoryError> {
    let Request { steps, every, .. } = *request;
    let mut values = Vec::with_capacity(2 * D + 1);
    let mut show = |sample: Sample<S, D>| {
        values.clear();
        values.extend(sample.state.coordinates());
        values.push(energy(&sample.state));
        rows.row(&[sample.step], sample.time, &values)
    };
    show(simulation.sample())?;
    let (mut step, mut shown) = (0, 0);
    while step < steps {
        if watch.stops() {
            return Err(TrajectoryError::Interrupted);
        }
        let to_next_row = (every - step % every).min(steps - step);
        let outcome = simulation.run(to_next_row.min(CHUNK));
        step = simulation.sample().step;
        watch.reached(step);
        let ended = outcome.is_err() || step == steps;
        if step != shown && (ended || step.is_multiple_of(every)) {
            show(simulation.sample())?;
            shown = step;
        }
        match outcome {
            Ok(()) => {}
            Err(SimulationError::NotFinite { step, time: t }) => {
                let reason = "the state stopped being finite".to_owned();
                let reason = match overflow::cause::<S>(request) {
                    Some(cause) => reason + ": " + &cause,
                    None => reason,
                };
                return Ok(Ending::Stopped(Stopped { step, t, reason }));
            }
            Err(error) => return Err(error.into()),
        }
    }
    Ok(Ending::Whole)
}
