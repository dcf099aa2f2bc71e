//! Whether a data set can be computed here.

use libration::ensemble::{EnsembleError, NoRoom};
use libration::rl::{Plan, Rollout};

use super::world::{Number, Visit};
use super::{Dataset, DatasetError};
use crate::environments::{Actor, Batch};

/// Takes a step, if there is memory for all that is on its way at once, and the policy fits.
pub(super) struct Try<'a>(pub(super) &'a Dataset);

/// Chunks that are computed, encoded and written at once, and as much again of what is made of them.
const AT_ONCE: u128 = 2 * 4;

impl Visit for Try<'_> {
    type Output = Result<(), DatasetError>;

    fn visit<T: Number, const O: usize>(
        self,
        mut all: Box<dyn Batch<T, O>>,
        actor: Actor<'static, T, O>,
    ) -> Self::Output {
        let Dataset { chunk, steps, .. } = *self.0;
        let horizon = steps.min(chunk.steps as u64) as usize;
        let plan = Plan::new(horizon, all.len()).truncated();
        NoRoom::check(AT_ONCE * plan.bytes(O, 1, size_of::<T>())).map_err(EnsembleError::from)?;
        let mut rollout = Rollout::new(Plan::new(1, all.len()).truncated())?;
        Ok(all.rollout(actor, &mut rollout)?)
    }
}
