//! One trajectory by the program of a step.

use libration::equations::{Evaluation, StepProgram};
use libration::simulation::{Sample, SimulationError, Simulator};
use libration::system::DynSystem;
use libration::{Float, Method, State};

use crate::newton_residual::{NewtonCheck, NewtonResidual};

/// A trajectory of a system without inputs, in steps of a program.
pub(crate) struct ProgramSimulation<'p, S, const D: usize> {
    step_of: Evaluation<'p, S>,
    /// Positions, velocities and the time step.
    inputs: Vec<S>,
    step: u64,
    check: Option<NewtonCheck<'p, S>>,
}

impl<'p, S: Float, const D: usize> ProgramSimulation<'p, S, D> {
    /// A trajectory from `start`, in steps of `dt` seconds.
    ///
    /// # Errors
    /// If `dt` is not positive and finite, or a coordinate of `start` is not finite.
    pub(crate) fn new(
        step: &'p StepProgram,
        start: State<S, D>,
        dt: S,
    ) -> Result<Self, SimulationError> {
        // The checks are those of every simulation.
        let still = |_: &State<S, D>| [S::zero(); D];
        Simulator::new(DynSystem(&still), Method::SymplecticEuler, start, dt)?;
        let inputs = start.coordinates().chain([dt]).collect();
        Ok(ProgramSimulation { step_of: step.program().on::<S>(), inputs, step: 0, check: None })
    }

    /// The same trajectory, whose steps are compared with those of a [further Newton step](crate::newton_residual::refined).
    pub(crate) fn checked(self, refined: Option<&'p StepProgram>) -> Self {
        let places = || (0..2 * D).collect();
        ProgramSimulation { check: refined.map(|step| NewtonCheck::new(step, places())), ..self }
    }

    /// What the Newton steps left so far; none without a comparison.
    pub(crate) fn newton_residual(&self) -> Option<NewtonResidual> {
        self.check.as_ref().and_then(NewtonCheck::found)
    }

    /// Takes `steps` steps and shows the state after each of them.
    ///
    /// # Errors
    /// [`SimulationError::NotFinite`] names the first step whose result is not finite; the trajectory stands before it.
    pub(crate) fn run(
        &mut self,
        steps: u64,
        observe: &mut dyn FnMut(&Sample<S, D>),
    ) -> Result<(), SimulationError> {
        let mut next = Vec::with_capacity(2 * D);
        for _ in 0..steps {
            next.clear();
            next.extend(self.step_of.run(&self.inputs));
            if !next.iter().all(|x| x.is_finite()) {
                let step = self.step + 1;
                return Err(SimulationError::NotFinite { step, time: self.time_of(step) });
            }
            self.step += 1;
            if let Some(check) = &mut self.check {
                check.observe(&self.inputs, &next, self.step);
            }
            self.inputs[..2 * D].copy_from_slice(&next);
            observe(&self.sample());
        }
        Ok(())
    }

    /// The current sample of the trajectory.
    pub(crate) fn sample(&self) -> Sample<S, D> {
        let state = State {
            q: std::array::from_fn(|i| self.inputs[i]),
            v: std::array::from_fn(|i| self.inputs[D + i]),
        };
        Sample { step: self.step, time: self.time_of(self.step), state }
    }

    fn time_of(&self, step: u64) -> f64 {
        step as f64 * self.inputs[2 * D].to_f64()
    }
}
