//! Dispatch from a request to the loop over steps.

use libration::ensemble::dynamics_of;
use libration::equations::StepProgram;
use libration::simulation::{Sample, SimulationError, Simulator};
use libration::system::DynSystem;
use libration::{
    AnySystem, Float, Hamiltonian, Integrator, Model, Scalar, State, System, with_method,
    with_system,
};

use super::ensemble::EnsembleFloat;
use super::exact_step::exact;
use super::{Divergence, Monitor, Outcome, Request, TrajectoryError, overflow};
use crate::Stepping;
use crate::export::{Number, Rows};
use crate::newton_residual::{NewtonResidual, refined};
use crate::program_simulation::ProgramSimulation;

/// Steps between two checks of the monitor.
const CHUNK: u64 = 1 << 16;

/// Simulates the checked `request` in the float type `S`.
pub(super) fn run<S: EnsembleFloat>(
    request: &Request,
    rows: &mut dyn Rows<S>,
    monitor: &dyn Monitor,
) -> Result<Outcome, TrajectoryError> {
    if request.loop_option().is_some() {
        return S::run_loops(request, rows, monitor);
    }
    match (request.ensemble, request.stepping) {
        (None, _) => {}
        (Some(ensemble), Stepping::Method(method)) => {
            return S::run_ensemble(request, method.into(), &ensemble, rows, monitor);
        }
        (Some(ensemble), Stepping::Implicit(method)) => {
            return S::run_ensemble(request, method.into(), &ensemble, rows, monitor);
        }
        (Some(_), Stepping::Exact) => return S::run_loops(request, rows, monitor),
    }
    let dimension = request.q.len();
    let wrong = || Err(request.system.entry().wrong_dimension(dimension).into());
    with_system!(
        request.system,
        compiled_dimension(request.system, dimension),
        |model, D| {
            if const { D <= NARROW || D == WIDE } {
                on_model::<S, D, _>(&model, request, rows, monitor)
            } else {
                wrong()
            }
        },
        wrong()
    )
}

/// Largest dimension with a simulation of its own.
const NARROW: usize = 2;

/// Largest dimension of an oscillator in the catalogue.
const WIDE: usize = 8;

/// The dimension in which a system is simulated: the largest for an oscillator in 3 to 8 dimensions. Its coordinates do not depend
/// on each other, so additional zeros change no bit, and six dimensions share one simulation per float type.
fn compiled_dimension(system: AnySystem, dimension: usize) -> usize {
    match system {
        AnySystem::Oscillator(_) if (NARROW + 1..=WIDE).contains(&dimension) => WIDE,
        _ => dimension,
    }
}

fn on_model<S: EnsembleFloat, const D: usize, M: Model<D>>(
    model: &M,
    request: &Request,
    rows: &mut dyn Rows<S>,
    monitor: &dyn Monitor,
) -> Result<Outcome, TrajectoryError> {
    let system = model.on::<S>();
    let coordinates = |x: &[f64]| core::array::from_fn(|i| x.get(i).map_or(S::zero(), number));
    let start = State { q: coordinates(&request.q), v: coordinates(&request.v) };
    let dt = S::from_f64(request.dt);
    let energy = |state: &State<S, D>| system.energy(state);
    // The model is converted per step because it can be shared between threads.
    let acceleration = |state: &State<S, D>| model.on::<S>().acceleration(state);
    let chosen = DynSystem(&acceleration);
    let mut refined_step = None;
    let program = match request.stepping {
        Stepping::Implicit(method) => {
            let wrong = || request.system.entry().wrong_dimension(D);
            let dynamics = dynamics_of(request.system, D).ok_or_else(wrong)?;
            refined_step = refined(method.into(), &dynamics);
            Some(StepProgram::implicit(method, &dynamics))
        }
        _ => None,
    };
    // Separate loops per method only where the speed justifies the compilation.
    let mut simulation: Box<dyn Simulation<S, D> + '_> = match (request.stepping, &program) {
        (_, Some(program)) => {
            let simulation = ProgramSimulation::new(program, start, dt)?;
            Box::new(simulation.checked(refined_step.as_ref()))
        }
        (Stepping::Method(method), _) if const { S::IS_NATIVE && D <= NARROW } => {
            with_method!(method, |integrator| {
                Box::new(Simulator::new(system, integrator, start, dt)?)
            })
        }
        (Stepping::Method(method), _) => Box::new(Simulator::new(chosen, method, start, dt)?),
        (Stepping::Implicit(_) | Stepping::Exact, _) => Box::new(Simulator::new(
            system,
            exact(model, request.dt, request.longest())?,
            start,
            dt,
        )?),
    };
    advance(&mut *simulation, &energy, request, rows, monitor)
}

fn number<S: Scalar>(x: &f64) -> S {
    S::from_f64(*x)
}

/// The interface of a simulator to the loop over rows, which is compiled per float type and dimension
/// instead of per simulator.
trait Simulation<S, const D: usize> {
    fn run(&mut self, steps: u64) -> Result<(), SimulationError>;
    fn sample(&self) -> Sample<S, D>;

    /// What the iterations of its steps left; none without iterations.
    fn newton_residual(&self) -> Option<NewtonResidual> {
        None
    }
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

impl<S: Float, const D: usize> Simulation<S, D> for ProgramSimulation<'_, S, D> {
    fn run(&mut self, steps: u64) -> Result<(), SimulationError> {
        ProgramSimulation::run(self, steps, &mut |_| {})
    }

    fn sample(&self) -> Sample<S, D> {
        ProgramSimulation::sample(self)
    }

    fn newton_residual(&self) -> Option<NewtonResidual> {
        ProgramSimulation::newton_residual(self)
    }
}

/// Runs `simulation` to the end and passes the start, each `every`-th step and the last step to `rows`.
fn advance<S: Number, const D: usize>(
    simulation: &mut dyn Simulation<S, D>,
    energy: &dyn Fn(&State<S, D>) -> S,
    request: &Request,
    rows: &mut dyn Rows<S>,
    monitor: &dyn Monitor,
) -> Result<Outcome, TrajectoryError> {
    let Request { steps, every, .. } = *request;
    let dimension = request.q.len();
    let mut values = Vec::with_capacity(2 * dimension + 1);
    let mut show = |sample: Sample<S, D>| {
        values.clear();
        for coordinates in [&sample.state.q, &sample.state.v] {
            values.extend_from_slice(&coordinates[..dimension.min(D)]);
        }
        values.push(energy(&sample.state));
        rows.row(&[sample.step], sample.time, &values)
    };
    show(simulation.sample())?;
    let (mut step, mut shown) = (0, 0);
    while step < steps {
        if monitor.should_stop() {
            return Err(TrajectoryError::Interrupted);
        }
        let to_next_row = (every - step % every).min(steps - step);
        let outcome = simulation.run(to_next_row.min(CHUNK));
        step = simulation.sample().step;
        monitor.on_step(step);
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
                let outcome =
                    Outcome::Diverged(Divergence { step, t, reason, newton_residual: None });
                return Ok(outcome.with_residual(simulation.newton_residual()));
            }
            Err(error) => return Err(error.into()),
        }
    }
    Ok(Outcome::Complete.with_residual(simulation.newton_residual()))
}
