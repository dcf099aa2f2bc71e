//! Systems whose motion is simulated.

use libration::integrator::Exact;
use libration::system::DynSystem;
use libration::{Float, Hamiltonian, Integrator, Method, Model, State, System};

/// A function that writes the accelerations of a state.
pub(super) type Accelerations<'a> = Box<dyn FnMut(&[f64], &mut [f64]) + 'a>;

/// A function of the energy of a state.
pub(super) type Energy<'a> = Box<dyn FnMut(&[f64]) -> f64 + 'a>;

/// A function that writes the derivatives of the accelerations at a state by the coordinate at a place.
pub(super) type Slopes<'a> = Box<dyn FnMut(&[f64], usize, &mut [f64]) + 'a>;

/// A system with positions, then velocities, in one list.
pub(super) trait SimulatedSystem: Sync {
    /// Degrees of freedom.
    fn degrees(&self) -> usize;

    /// The places of the states that are compared, rising.
    fn states(&self) -> &[usize];

    /// The most steps of a run, and of one that is compared with finer steps: a search takes hundreds of runs.
    fn most_steps(&self) -> [f64; 2];

    /// Whether accelerations depend on positions alone: elsewhere splitting methods lose their order.
    fn is_positional(&self) -> bool;

    /// The method with the smaller error of those with code of their own that are of order four on this system.
    fn reference_method(&self) -> Method {
        if self.is_positional() { Method::Suzuki4 } else { Method::Rk4 }
    }

    /// The largest angle of an exact step of a second, of a linear system that has exact steps, in rad.
    fn exact_rate(&self) -> Option<f64>;

    /// The accelerations.
    fn accelerations(&self) -> Accelerations<'_>;

    /// The derivatives of the accelerations.
    fn slopes(&self) -> Slopes<'_>;

    /// Whether accelerations depend on time, which is no compared state.
    fn depends_on_time(&self) -> bool;

    /// Whether accelerations have no kinks and jumps.
    fn is_smooth(&self) -> bool;

    /// The energy, if there is one.
    fn energy(&self) -> Option<Energy<'_>>;

    /// Steps of an integrator in `f32` or `f64`.
    fn steps(&self, is_narrow: bool, method: Method, dt: f64, start: &[f64])
    -> Box<dyn Steps + '_>;

    /// Exact steps, of a linear system that has them.
    fn exact_steps(&self, dt: f64, start: &[f64]) -> Option<Box<dyn Steps + '_>>;
}

/// A trajectory, step by step.
pub(super) trait Steps {
    /// Positions, then velocities, after another step.
    fn next(&mut self) -> &[f64];
}

/// A compiled model.
pub(super) struct Compiled<M, const D: usize> {
    model: M,
    states: Vec<usize>,
}

impl<M, const D: usize> Compiled<M, D> {
    pub(super) fn new(model: M) -> Self {
        Compiled { model, states: (0..2 * D).collect() }
    }
}

fn state_of<const D: usize>(coordinates: &[f64]) -> State<f64, D> {
    State {
        q: core::array::from_fn(|i| coordinates[i]),
        v: core::array::from_fn(|i| coordinates[D + i]),
    }
}

impl<M: Model<D>, const D: usize> SimulatedSystem for Compiled<M, D> {
    fn degrees(&self) -> usize {
        D
    }

    fn states(&self) -> &[usize] {
        &self.states
    }

    fn most_steps(&self) -> [f64; 2] {
        [2e7, 1e6]
    }

    fn is_positional(&self) -> bool {
        <M::On<f64> as System<f64, D>>::POSITIONAL
    }

    fn exact_rate(&self) -> Option<f64> {
        Exact::angle(self.model, 1.0)
    }

    fn accelerations(&self) -> Accelerations<'_> {
        let system = self.model.on::<f64>();
        Box::new(move |state, to| to.copy_from_slice(&system.acceleration(&state_of::<D>(state))))
    }

    fn slopes(&self) -> Slopes<'_> {
        let system = self.model.on::<f64>();
        Box::new(move |state, place, to| {
            let size = |part: &[f64]| part.iter().fold(0.0, |size: f64, x| size.hypot(*x));
            let part = if place < D { &state[..D] } else { &state[D..] };
            let far = 1e-6 * size(part).max(1e-3);
            let mut beside = state_of::<D>(state);
            let here = system.acceleration(&beside);
            let moved = if place < D { &mut beside.q[place] } else { &mut beside.v[place - D] };
            *moved += far;
            let there = system.acceleration(&beside);
            to.iter_mut().enumerate().for_each(|(i, to)| *to = (there[i] - here[i]) / far);
        })
    }

    fn depends_on_time(&self) -> bool {
        // A system of the catalogue has time as a state that moves.
        false
    }

    fn is_smooth(&self) -> bool {
        true
    }

    fn energy(&self) -> Option<Energy<'_>> {
        let system = self.model.on::<f64>();
        Some(Box::new(move |state| system.energy(&state_of::<D>(state))))
    }

    fn steps(
        &self,
        is_narrow: bool,
        method: Method,
        dt: f64,
        start: &[f64],
    ) -> Box<dyn Steps + '_> {
        match is_narrow {
            true => Box::new(self.steps_on::<f32>(method, dt, start)),
            false => Box::new(self.steps_on::<f64>(method, dt, start)),
        }
    }

    fn exact_steps(&self, dt: f64, start: &[f64]) -> Option<Box<dyn Steps + '_>> {
        let exact = Exact::new(self.model, dt)?;
        let model = self.model;
        let step = move |state| {
            let acceleration = |state: &State<f64, D>| model.on::<f64>().acceleration(state);
            exact.step(&DynSystem(&acceleration), state, dt)
        };
        Some(Box::new(CompiledSteps { step, state: state_of::<D>(start), shown: start.to_vec() }))
    }
}

impl<M: Model<D>, const D: usize> Compiled<M, D> {
    fn steps_on<S: Float>(
        &self,
        method: Method,
        dt: f64,
        start: &[f64],
    ) -> CompiledSteps<S, impl FnMut(State<S, D>) -> State<S, D> + use<S, M, D>, D> {
        let (model, dt) = (self.model, S::from_f64(dt));
        let step = move |state| {
            // The steps of all methods are compiled once for all systems.
            let acceleration = |state: &State<S, D>| model.on::<S>().acceleration(state);
            method.step(&DynSystem(&acceleration), state, dt)
        };
        let state = state_of::<D>(start).map(S::from_f64);
        CompiledSteps { step, state, shown: start.to_vec() }
    }
}

struct CompiledSteps<S, F, const D: usize> {
    step: F,
    state: State<S, D>,
    shown: Vec<f64>,
}

impl<S: Float, F: FnMut(State<S, D>) -> State<S, D>, const D: usize> Steps
    for CompiledSteps<S, F, D>
{
    fn next(&mut self) -> &[f64] {
        self.state = (self.step)(self.state);
        let shown = self.shown.iter_mut().zip(self.state.coordinates());
        shown.for_each(|(to, x)| *to = x.to_f64());
        &self.shown
    }
}
