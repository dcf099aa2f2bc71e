//! A model with a start and the time of a turn.

use std::sync::OnceLock;

use libration::number::TwoFloat;
use libration::simulation::{Sample, SimulationError, Simulator};
use libration::system::DynSystem;
use libration::{Float, Method, Model, Scalar, State, System, with_method};

use super::orbit::Orbit;

/// A system of any kind under study: all that the laboratory must know of it.
///
/// ```
/// use libration::{State, system::Duffing};
/// use libration_study_motion::{Convergence, Nonlinear, Problem, Subject};
///
/// let wells = Duffing { alpha: -1.0, beta: 1.0 };
/// let problem = Problem::new("wells", wells, State { q: [1.5], v: [0.0] }, 4.4);
/// let own = [&problem as &dyn Subject];
/// let studies = (Convergence::of(&own), Nonlinear::of(&own));
/// # let _ = studies;
/// ```
#[derive(Debug)]
pub struct Problem<M, const D: usize> {
    pub(super) name: String,
    pub(super) title: String,
    pub(super) model: M,
    pub(super) start: State<f64, D>,
    pub(super) turn: f64,
    pub(super) equilibrium: Option<State<f64, D>>,
    orbit: OnceLock<Orbit<D>>,
}

impl<M: Model<D>, const D: usize> Problem<M, D> {
    /// `model` from `start`; a revolution takes about `turn` seconds.
    ///
    /// Characters of `name` other than letters and digits become hyphens.
    pub fn new(name: &str, model: M, start: State<f64, D>, turn: f64) -> Self {
        let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '-' };
        Problem {
            name: name.chars().map(plain).collect(),
            title: name.into(),
            model,
            start,
            turn,
            equilibrium: None,
            orbit: OnceLock::new(),
        }
    }

    /// With a name for running text.
    #[must_use]
    pub fn titled(mut self, title: &str) -> Self {
        self.title = title.into();
        self
    }

    /// With a stable equilibrium, about which the step of lost stability is predicted.
    #[must_use]
    pub fn with_equilibrium(mut self, equilibrium: State<f64, D>) -> Self {
        self.equilibrium = Some(equilibrium);
        self
    }

    /// The reference orbit, computed once.
    pub(super) fn orbit(&self) -> &Orbit<D> {
        self.orbit.get_or_init(|| {
            let turn = TwoFloat::from_f64(self.turn);
            Orbit::new(&self.model.on(), self.start.map(TwoFloat::from_f64), turn)
        })
    }

    /// `turn / steps` on numbers of type `S`.
    pub(super) fn step<S: Scalar>(&self, steps: u64) -> S {
        S::from_f64(self.turn).ratio(1, i32::try_from(steps).unwrap_or(i32::MAX))
    }

    /// Runs `method` and gives the last state; `watch` sees every sample.
    ///
    /// But for `sweep` the one place in which a method becomes a type: what watches is dynamic.
    pub(super) fn run<S: Float>(
        &self,
        method: Method,
        start: State<S, D>,
        dt: S,
        steps: u64,
        watch: &mut dyn FnMut(&Sample<S, D>),
    ) -> Result<State<S, D>, SimulationError> {
        let watch = &mut |sample: &Sample<S, D>| watch(sample);
        if const { size_of::<S>() > size_of::<f64>() } {
            // What each operation takes is more than a call.
            let acceleration = |state: &State<S, D>| self.model.on::<S>().acceleration(state);
            let mut simulator = Simulator::new(DynSystem(&acceleration), method, start, dt)?;
            simulator.run(steps, watch)?;
            return Ok(simulator.sample().state);
        }
        let system = self.model.on::<S>();
        with_method!(method, |m| {
            let mut simulator = Simulator::new(system, m, start, dt)?;
            simulator.run(steps, watch)?;
            Ok(simulator.sample().state)
        })
    }
}
