//! Environments by programs.

use std::any::Any;
use std::ops::Range;

use libration::checkpoint::{Checkpoint, CheckpointError};
use libration::ensemble::Execution;
use libration::rl::{
    Discounts, EnvironmentError, Estimates, Plan, ProgramEnvironments, ProgramPolicy,
    ProgramRollout, StepBuffers,
};

use crate::any_batch::{DynBatch, Ends};
use crate::array::Number;
use crate::policy::Policy;
use crate::tensors::{Ended, Tensors};

/// Environments of a system by equations.
pub(crate) struct ProgramBatch<T: Number> {
    pub(crate) environments: ProgramEnvironments<T>,
    /// The places of its states among positions and velocities.
    pub(crate) places: Vec<usize>,
}

impl<T: Number> DynBatch<T> for ProgramBatch<T> {
    fn observations(&self) -> usize {
        self.environments.definition().observations()
    }

    fn actions(&self) -> usize {
        self.environments.definition().dynamics.inputs()
    }

    fn act(&mut self, actions: &[T], to: StepBuffers<'_, T>) -> Result<Ends<T>, EnvironmentError> {
        let ended = self.environments.act(ProgramPolicy::ActionSequence(actions), to)?;
        Ok(Ends {
            environments: ended.ends.iter().map(|end| end.environment).collect(),
            seen: ended.observations,
            lost: ended.ends.iter().map(|end| end.lost).collect(),
        })
    }

    fn tensors(&self, plan: Plan) -> Result<Box<dyn Tensors<T>>, EnvironmentError> {
        Ok(Box::new(ProgramRollout::<T>::new(plan, [self.observations(), self.actions()])?))
    }

    fn fill(
        &mut self,
        policy: &Policy<T>,
        tensors: &mut dyn Tensors<T>,
        rows: Range<usize>,
    ) -> Result<(), EnvironmentError> {
        let (found, wanted) = (tensors.observations(), self.observations());
        let Some(rollout) = tensors.as_any().downcast_mut::<ProgramRollout<T>>() else {
            let name = "numbers that an environment of the rollout shows";
            return Err(EnvironmentError::Shape { name, found, wanted });
        };
        self.environments.fill(policy.by_program(rollout.sizes()[1]), rollout, rows)
    }

    fn observe(&mut self, to: &mut [T]) -> Result<(), EnvironmentError> {
        self.environments.observe(to)
    }

    fn reset(&mut self, which: &[bool]) -> Result<(), EnvironmentError> {
        self.environments.reset(which)
    }

    fn end(&mut self, which: &[bool]) -> Result<(), EnvironmentError> {
        self.environments.end(which)
    }

    fn seed(&mut self, seeds: &[Option<u64>]) -> Result<(), EnvironmentError> {
        self.environments.seed(seeds)
    }

    fn execute(&mut self, execution: Execution) {
        self.environments.execute(execution);
    }

    fn states(&self) -> usize {
        self.places.len()
    }

    fn write_state(&self, n: usize, to: &mut [T]) {
        let state = self.environments.state(n).unwrap_or_default();
        for (to, &place) in to.iter_mut().zip(&self.places) {
            *to = state.get(place).copied().unwrap_or_else(T::zero);
        }
    }

    fn to_bytes(&self) -> Vec<u8> {
        self.environments.to_bytes()
    }

    fn restore(&mut self, state: &[u8]) -> Result<(), CheckpointError> {
        self.environments.restore(state)
    }
}

impl<T: Number> Tensors<T> for ProgramRollout<T> {
    fn plan(&self) -> Plan {
        self.transitions().plan()
    }

    fn observations(&self) -> usize {
        self.sizes()[0]
    }

    fn numbers(&self) -> Vec<(&'static str, &[T], usize)> {
        let [observations, actions] = self.sizes();
        let rest = self.transitions();
        vec![
            ("observations", self.observation(), observations),
            ("actions", self.action(), actions),
            ("rewards", rest.reward(), 0),
            ("log_probabilities", rest.log_probability(), 0),
            ("values", rest.value(), 0),
        ]
    }

    fn flags(&self) -> [(&'static str, &[u8]); 2] {
        let rest = self.transitions();
        [("terminated", rest.terminated()), ("truncated", rest.truncated())]
    }

    fn ends(&self) -> Ended<T> {
        Ended::new(self.transitions().finals(), self.final_observations().to_vec())
    }

    fn transitions(&self) -> Vec<bool> {
        ProgramRollout::transitions(self).transitions()
    }

    fn estimate(
        &self,
        to: &mut Estimates<T>,
        discounts: Discounts,
        next: &[T],
        last: &[T],
    ) -> Result<(), EnvironmentError> {
        ProgramRollout::estimate(self, to, discounts, next, last, &Execution::serial())
    }

    fn as_any(&mut self) -> &mut dyn Any {
        self
    }
}
