//! The measurements of a problem: its implementation of [`Subject`].

use libration::analysis::Linearisation;
use libration::ensemble::Execution;
use libration::number::TwoFloat;
use libration::{Float, Method, Model, State, integrator};
use libration_study::StudyError;

use super::{
    Change, Changes, Errors, Halvings, Horizon, Kind, Law, Orbits, Portrait, Problem,
    StabilityLimit, Subject, Symmetry, energy, errors, portrait, stability, symmetry,
};

impl<M: Model<D>, const D: usize> Subject for Problem<M, D>
where
    // Threads share it where many orbits are tried at once.
    M::On<f64>: Send + Sync,
{
    fn name(&self) -> &str {
        &self.name
    }

    fn title(&self) -> &str {
        &self.title
    }

    fn dimension(&self) -> usize {
        D
    }

    fn turn(&self) -> f64 {
        self.turn
    }

    fn law(&self) -> Law {
        let depends = |state: &State<TwoFloat, D>| {
            // The generator does not depend on the integrator or the step.
            let at = state.map(Float::to_f64);
            let any = Linearisation::new(integrator::Leapfrog, self.model, &at, self.turn);
            any.generator.dv.iter().any(|column| column.v.iter().any(|x| !x.is_zero()))
        };
        Law { linear: M::LINEAR, velocity_dependent: self.orbit().states().iter().any(depends) }
    }

    fn reference_error(&self) -> f64 {
        self.orbit().uncertainty()
    }

    fn errors(&self, kind: Kind, method: Method, halvings: Halvings) -> Result<Errors, StudyError> {
        errors::measure(self, kind, method, halvings)
    }

    fn changes(
        &self,
        change: Change,
        method: Method,
        halvings: Halvings,
    ) -> Result<Changes, StudyError> {
        energy::changes(self, change, method, halvings)
    }

    fn horizon(&self, method: Method, steps: u64, turns: u64) -> Result<Horizon, StudyError> {
        energy::horizon(self, method, steps, turns)
    }

    fn closes(&self) -> bool {
        energy::closes(self)
    }

    fn frequency(&self) -> Option<f64> {
        stability::frequency(self)
    }

    fn stability_limit(
        &self,
        execution: &Execution,
        orbits: Orbits,
        method: Method,
        steps: u64,
    ) -> Result<Option<StabilityLimit>, StudyError> {
        stability::stability_limit(self, execution, orbits, method, steps)
    }

    fn portrait(&self, method: Method, dt: f64, steps: u64) -> Result<Portrait, StudyError> {
        portrait::trace(self, method, dt, steps)
    }

    fn symmetry(&self, method: Method, steps: u64) -> Symmetry {
        symmetry::measure(self, method, steps)
    }
}
