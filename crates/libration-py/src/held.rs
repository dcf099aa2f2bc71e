//! Environments of which Python knows nothing but how many numbers they show.

use std::ops::Range;

use libration::checkpoint::CheckpointError;
use libration::ensemble::Execution;
use libration::rl::policy::ActionSequence;
use libration::rl::{EnvironmentError, Plan, Rollout, StepBuffers};
use libration_env::environments::{Actor, Batch, Recipe, Visit};

use crate::acts::Acts;
use crate::array::Number;
use crate::tensors::Tensors;

/// Episodes that ended in a step, by environment.
pub(crate) struct Ends<T> {
    /// Which.
    pub(crate) environments: Vec<usize>,
    /// What was seen last: `[k, i]`.
    pub(crate) seen: Vec<T>,
    /// Which were lost: a number of them was none.
    pub(crate) lost: Vec<bool>,
}

/// A [`Batch`] that shows any number of numbers.
pub(crate) trait Table<T>: Send {
    fn observations(&self) -> usize;

    fn act(&mut self, actions: &[T], to: StepBuffers<'_, T>) -> Result<Ends<T>, EnvironmentError>;

    fn tensors(&self, plan: Plan) -> Result<Box<dyn Tensors<T>>, EnvironmentError>;

    fn fill(
        &mut self,
        policy: &Acts<T>,
        tensors: &mut dyn Tensors<T>,
        rows: Range<usize>,
    ) -> Result<(), EnvironmentError>;

    fn observe(&mut self, to: &mut [T]) -> Result<(), EnvironmentError>;

    fn reset(&mut self, which: &[bool]) -> Result<(), EnvironmentError>;

    fn end(&mut self, which: &[bool]) -> Result<(), EnvironmentError>;

    fn seed(&mut self, seeds: &[Option<u64>]) -> Result<(), EnvironmentError>;

    fn execute(&mut self, execution: Execution);

    fn state(&self, n: usize) -> Option<[T; 2]>;

    fn to_bytes(&self) -> Vec<u8>;

    fn restore(&mut self, state: &[u8]) -> Result<(), CheckpointError>;
}

impl<T: Number, const O: usize> Table<T> for Box<dyn Batch<T, O>> {
    fn observations(&self) -> usize {
        O
    }

    fn act(&mut self, actions: &[T], to: StepBuffers<'_, T>) -> Result<Ends<T>, EnvironmentError> {
        let ends = (**self).act(Actor::Given(ActionSequence(actions)), to)?;
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
        policy: &Acts<T>,
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

    fn state(&self, n: usize) -> Option<[T; 2]> {
        (**self).state(n)
    }

    fn to_bytes(&self) -> Vec<u8> {
        (**self).to_bytes()
    }

    fn restore(&mut self, state: &[u8]) -> Result<(), CheckpointError> {
        (**self).restore(state)
    }
}

/// A table of either float type.
pub(crate) enum Held {
    F32(Box<dyn Table<f32>>),
    F64(Box<dyn Table<f64>>),
}

/// Does something with the table, whichever it is.
macro_rules! with_table {
    ($held:expr, $table:ident => $work:expr) => {
        match $held {
            $crate::held::Held::F32($table) => $work,
            $crate::held::Held::F64($table) => $work,
        }
    };
}
pub(crate) use with_table;

/// Takes what is visited as it is.
struct Keep;

impl<T: Number> Visit<T> for Keep {
    type Output = Box<dyn Table<T>>;

    fn visit<const O: usize>(self, all: Box<dyn Batch<T, O>>) -> Self::Output {
        Box::new(all)
    }
}

impl Held {
    /// So many environments of a recipe.
    pub(crate) fn new(
        recipe: &Recipe,
        single: bool,
        len: usize,
        execution: &Execution,
    ) -> Result<Self, EnvironmentError> {
        Ok(if single {
            Held::F32(recipe.with([0, len], 0, execution, Keep)?)
        } else {
            Held::F64(recipe.with([0, len], 0, execution, Keep)?)
        })
    }
}
