//! The measurements of a problem.

use libration::analysis::jacobian;
use libration::ensemble::Execution;
use libration::linear::Matrix;
use libration::{Float, Method};
use libration_analyze::reference_flow::{Rates, size};
use libration_analyze::step_order;
use libration_study::StudyError;

use super::{
    Change, Changes, Errors, Halvings, Horizon, Kind, Law, Orbits, Portrait, Problem,
    StabilityLimit, StudiedState, Symmetry, energy, errors, portrait, rounding, stability,
    symmetry,
};

/// Part of the largest slope by which symmetric ones may differ: rounding of expressions that are equal in exact arithmetic.
const ASYMMETRY: f64 = 1e-9;

/// Steps a turn at which an order is derived: so small that a leading term with a small factor shows, and so large that the rounding of
/// the weights of a method to `f64` does not.
const ORDER_STEPS: u64 = 256;

/// Part of the size of an orbit below which an error against the reference is its rounding.
const RESOLVED: f64 = 1e-25;

impl Problem {
    /// Name in identifiers and files, as in `pendulum`.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Name in running text.
    pub fn title(&self) -> &str {
        &self.title
    }

    /// About the time that one revolution takes, in s; time steps are given as fractions of it.
    pub fn turn(&self) -> f64 {
        self.turn
    }

    /// Returns the properties of the acceleration, from its Jacobian along the orbit.
    pub fn law(&self) -> Law {
        let degrees = self.degrees();
        let slopes = |state: &Vec<_>| {
            let at: Vec<f64> = state.iter().copied().map(Float::to_f64).collect();
            jacobian(&self.dynamics, &at)
        };
        let slopes: Vec<Matrix> = self.orbit().states().iter().map(slopes).collect();
        let by_velocity = |slopes: &Matrix| {
            (0..degrees).any(|i| (degrees..2 * degrees).any(|j| slopes[(i, j)] != 0.0))
        };
        let is_symmetric = |slopes: &Matrix| {
            let pairs = || (0..degrees).flat_map(|i| (0..degrees).map(move |j| (i, j)));
            let most = pairs().map(|place| slopes[place].abs()).fold(0.0, f64::max);
            pairs().all(|(i, j)| (slopes[(i, j)] - slopes[(j, i)]).abs() <= ASYMMETRY * most)
        };
        let polynomial_degrees = self.dynamics.accelerations().polynomial_degrees(|_| true);
        Law {
            linear: polynomial_degrees.iter().all(|degree| degree.is_some_and(|d| d <= 1)),
            velocity_dependent: slopes.iter().any(by_velocity),
            has_potential: slopes.iter().all(is_symmetric),
        }
    }

    /// How far the reference orbit may be off, relative to the size of the orbit: the largest
    /// difference from the same with half the step.
    pub fn reference_error(&self) -> f64 {
        self.orbit().uncertainty()
    }

    /// Returns the errors of `method` at halved steps, until their order settles.
    ///
    /// # Errors
    /// If no time step or start is possible.
    pub fn errors(
        &self,
        kind: Kind,
        method: Method,
        halvings: Halvings,
    ) -> Result<Errors, StudyError> {
        errors::measure(self, kind, method, halvings)
    }

    /// Returns the change of the energy with `method` at halved steps, until the order settles.
    ///
    /// # Errors
    /// If no time step or start is possible.
    pub fn changes(
        &self,
        change: Change,
        method: Method,
        halvings: Halvings,
    ) -> Result<Changes, StudyError> {
        energy::changes(self, change, method, halvings)
    }

    /// The running maximum of the energy drift over `turns` turns of `steps` steps.
    ///
    /// # Errors
    /// If no time step or start is possible.
    pub fn horizon(&self, method: Method, steps: u64, turns: u64) -> Result<Horizon, StudyError> {
        energy::horizon(self, method, steps, turns)
    }

    /// Whether the orbit is closed: what is odd under time reversal averages out over it.
    pub fn closes(&self) -> bool {
        energy::closes(self)
    }

    /// The largest relative change of the energy along the exact orbit, over three quarters of a turn; none without an energy.
    pub fn energy_change_of_flow(&self) -> Option<f64> {
        energy::change_of_flow(self)
    }

    /// The order of `method` on this system from one step in 1024 bits; none if the step has no error.
    pub fn derived_order(&self, method: Method) -> Option<u32> {
        let mut start = self.start.clone();
        start.resize(start.len() + self.dynamics.inputs(), 0.0);
        let places: Vec<usize> = self.states.iter().map(|state| state.place).collect();
        step_order(&self.step_program(method), &start, &places, self.step(ORDER_STEPS))
    }

    /// Errors below this are rounding of the reference, which is known to some 10⁻²⁸ of its size.
    pub fn rounding(&self) -> f64 {
        let sizes = self.orbit().states().iter().map(|state| size(state));
        RESOLVED * sizes.fold(0.0, f64::max)
    }

    /// How far the rounding of floats of type `S` moves the orbit in so many turns, as a part of its largest state; none where a state
    /// leaves the range of `S`.
    ///
    /// # Errors
    /// If no time step or start is possible.
    pub fn rounding_error<S: Float>(
        &self,
        method: Method,
        steps: u64,
        turns: u64,
    ) -> Result<Option<f64>, StudyError> {
        rounding::measure::<S>(self, method, steps, turns)
    }

    /// How far halving the step moves the orbit in so many turns, as a part of its largest state.
    ///
    /// # Errors
    /// If no time step or start is possible.
    pub fn step_error(
        &self,
        method: Method,
        steps: u64,
        turns: u64,
    ) -> Result<Option<f64>, StudyError> {
        rounding::of_step(self, method, steps, turns)
    }

    /// The states under study.
    pub fn states(&self) -> &[StudiedState] {
        &self.states
    }

    /// Whether the orbit stays in a bounded part of space, as far as some turns show.
    pub fn is_bounded(&self) -> bool {
        energy::is_bounded(self)
    }

    /// Whether no state under study changes at the start.
    pub fn rests_at_start(&self) -> bool {
        let rates = Rates::new(&self.dynamics).at(&self.start);
        !self.depends_on_time() && self.states.iter().all(|state| rates[state.place] == 0.0)
    }

    /// Whether an acceleration depends on time, a degree of freedom of which nothing is under study.
    fn depends_on_time(&self) -> bool {
        let is_studied = |place| self.states.iter().any(|state| state.place == place);
        let is_time = |i: usize| !is_studied(i) && !is_studied(self.degrees() + i);
        let mut inputs = self.dynamics.accelerations().inputs_in_use();
        inputs.any(|input| input < self.degrees() && is_time(input))
    }

    /// The highest angular frequency of small oscillations about the equilibrium, in rad/s.
    pub fn frequency(&self) -> Option<f64> {
        stability::frequency(self)
    }

    /// Up to which time step no orbit of `steps` steps is lost; none if nothing is lost however large
    /// the step.
    pub fn stability_limit(
        &self,
        execution: &Execution,
        orbits: Orbits,
        method: Method,
        steps: u64,
    ) -> Option<StabilityLimit> {
        stability::stability_limit(self, execution, orbits, method, steps)
    }

    /// The first `steps` points of the orbit at a time step `dt`.
    ///
    /// # Errors
    /// If no time step or start is possible.
    pub fn portrait(&self, method: Method, dt: f64, steps: u64) -> Result<Portrait, StudyError> {
        portrait::trace(self, method, dt, steps)
    }

    /// The operations of the Jacobian of a step.
    pub fn symmetry_operations(&self, method: Method) -> usize {
        self.start.len() * self.step_program(method).program().operations()
    }

    /// The defects of one step at `steps` steps a turn, the root of their mean square along the
    /// orbit, in 1024 bits.
    pub fn symmetry(&self, method: Method, steps: u64) -> Symmetry {
        symmetry::measure(self, method, steps)
    }
}
