//! Type-erased environments.

use std::ops::Range;

use libration::checkpoint::CheckpointError;
use libration::ensemble::Execution;
use libration::rl::policy::ActionSequence;
use libration::rl::{
    EnvironmentError, Plan, ProgramEnvironment, ProgramEnvironments, Rollout, StepBuffers,
};
use libration_env::environments::{
    AnyEnvironments, AnyPolicy, EnvironmentSettings, EnvironmentsVisitor,
};

use crate::array::Number;
use crate::policy::Policy;
use crate::program_batch::ProgramBatch;
use crate::tensors::Tensors;

/// Episodes that ended in a step, by environment.
pub(crate) struct Ends<T> {
    /// Indices of the environments.
    pub(crate) environments: Vec<usize>,
    /// Final observations, `[k, i]`.
    pub(crate) seen: Vec<T>,
    /// Whether the state was not finite.
    pub(crate) lost: Vec<bool>,
}

/// [`AnyEnvironments`] with any number of observed numbers.
pub(crate) trait DynBatch<T>: Send {
    fn observations(&self) -> usize;

    /// The numbers of an action.
    fn actions(&self) -> usize {
        1
    }

    fn act(&mut self, actions: &[T], to: StepBuffers<'_, T>) -> Result<Ends<T>, EnvironmentError>;

    fn tensors(&self, plan: Plan) -> Result<Box<dyn Tensors<T>>, EnvironmentError>;

    fn fill(
        &mut self,
        policy: &Policy<T>,
        tensors: &mut dyn Tensors<T>,
        rows: Range<usize>,
    ) -> Result<(), EnvironmentError>;

    fn observe(&mut self, to: &mut [T]) -> Result<(), EnvironmentError>;

    fn reset(&mut self, which: &[bool]) -> Result<(), EnvironmentError>;

    fn end(&mut self, which: &[bool]) -> Result<(), EnvironmentError>;

    fn seed(&mut self, seeds: &[Option<u64>]) -> Result<(), EnvironmentError>;

    fn execute(&mut self, execution: Execution);

    /// The numbers of a state.
    fn states(&self) -> usize {
        2
    }

    /// Writes the state of environment `n`.
    fn write_state(&self, n: usize, to: &mut [T]);

    fn to_bytes(&self) -> Vec<u8>;

    fn restore(&mut self, state: &[u8]) -> Result<(), CheckpointError>;
}

impl<T: Number, const O: usize> DynBatch<T> for Box<dyn AnyEnvironments<T, O>> {
    fn observations(&self) -> usize {
        O
    }

    fn act(&mut self, actions: &[T], to: StepBuffers<'_, T>) -> Result<Ends<T>, EnvironmentError> {
        let ends = (**self).act(AnyPolicy::ActionSequence(ActionSequence(actions)), to)?;
        Ok(Ends {
            environments: ends.iter().map(|end| end.environment).collect(),
            seen: ends.iter().flat_map(|end| end.observation).collect(),
            lost: ends.iter().map(|end| end.lost).collect(),
        })
    }

    fn tensors(&self, plan: Plan) -> Result<Box<dyn Tensors<T>>, EnvironmentError> {
        Ok(Box::new(Rollout::<T, O, 1>::new(plan)?))
    }

    fn fill(
        &mut self,
        policy: &Policy<T>,
        tensors: &mut dyn Tensors<T>,
        rows: Range<usize>,
    ) -> Result<(), EnvironmentError> {
        let found = tensors.observations();
        let Some(rollout) = tensors.as_any().downcast_mut::<Rollout<T, O, 1>>() else {
            let name = "numbers that an environment of the rollout shows";
            return Err(EnvironmentError::Shape { name, found, wanted: O });
        };
        (**self).fill(policy.actor(), rollout, rows)
    }

    fn observe(&mut self, to: &mut [T]) -> Result<(), EnvironmentError> {
        (**self).observe(to)
    }

    fn reset(&mut self, which: &[bool]) -> Result<(), EnvironmentError> {
        (**self).reset(which)
    }

    fn end(&mut self, which: &[bool]) -> Result<(), EnvironmentError> {
        (**self).end(which)
    }

    fn seed(&mut self, seeds: &[Option<u64>]) -> Result<(), EnvironmentError> {
        (**self).seed(seeds)
    }

    fn execute(&mut self, execution: Execution) {
        (**self).execute(execution);
    }

    fn write_state(&self, n: usize, to: &mut [T]) {
        to.copy_from_slice(&(**self).state(n).unwrap_or([T::zero(); 2]));
    }

    fn to_bytes(&self) -> Vec<u8> {
        (**self).to_bytes()
    }

    fn restore(&mut self, state: &[u8]) -> Result<(), CheckpointError> {
        (**self).restore(state)
    }
}

/// A batch of either float type.
pub(crate) enum AnyBatch {
    F32(Box<dyn DynBatch<f32>>),
    F64(Box<dyn DynBatch<f64>>),
}

/// Evaluates an expression for a batch of either float type.
macro_rules! with_batch {
    ($batch:expr, $any:ident => $work:expr) => {
        match $batch {
            $crate::any_batch::AnyBatch::F32($any) => $work,
            $crate::any_batch::AnyBatch::F64($any) => $work,
        }
    };
}
pub(crate) use with_batch;

/// Takes what is visited as it is.
struct Keep;

impl<T: Number> EnvironmentsVisitor<T> for Keep {
    type Output = Box<dyn DynBatch<T>>;

    fn visit<const O: usize>(self, all: Box<dyn AnyEnvironments<T, O>>) -> Self::Output {
        Box::new(all)
    }
}

impl AnyBatch {
    /// Returns environments of these settings.
    pub(crate) fn catalogued(
        environments: &EnvironmentSettings,
        single: bool,
        len: usize,
        execution: &Execution,
    ) -> Result<Self, EnvironmentError> {
        Ok(if single {
            AnyBatch::F32(environments.with([0, len], 0, execution, Keep)?)
        } else {
            AnyBatch::F64(environments.with([0, len], 0, execution, Keep)?)
        })
    }

    /// Returns environments of a definition, whose states have these places among positions and velocities.
    pub(crate) fn by_program(
        definition: ProgramEnvironment,
        places: Vec<usize>,
        single: bool,
        len: usize,
        execution: &Execution,
    ) -> Result<Self, EnvironmentError> {
        fn batch<T: Number>(
            definition: ProgramEnvironment,
            places: Vec<usize>,
            len: usize,
            execution: &Execution,
        ) -> Result<Box<dyn DynBatch<T>>, EnvironmentError> {
            let environments =
                ProgramEnvironments::shard(definition, 0, len, 0, execution.clone())?;
            Ok(Box::new(ProgramBatch { environments, places }))
        }
        Ok(if single {
            AnyBatch::F32(batch(definition, places, len, execution)?)
        } else {
            AnyBatch::F64(batch(definition, places, len, execution)?)
        })
    }
}
