//! Precomputed actions.

use libration_core::Float;
use libration_core::array::each;

use super::{ActionSample, Policy, StepIndex};
use crate::rl::EnvironmentError;

/// Actions for a whole horizon: `[t, n, i]`.
///
/// An action that is not finite loses its environment and no other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ActionSequence<'a, T>(
    /// The actions.
    pub &'a [T],
);

impl<T: Float, const O: usize, const D: usize> Policy<T, O, D> for ActionSequence<'_, T> {
    fn check(&self, environments: usize, horizon: usize) -> Result<(), EnvironmentError> {
        let wanted = environments.saturating_mul(horizon).saturating_mul(D);
        EnvironmentError::shape("actions", self.0.len(), wanted)
    }

    fn uses_observations(&self) -> bool {
        false
    }

    #[inline(always)]
    fn act(&self, place: StepIndex, _: &[T; O], _: &mut impl FnMut() -> u32) -> ActionSample<T, D> {
        // Lanes beyond the last environment find nothing.
        let first = (place.row * place.environments + place.environment) * D;
        ActionSample::deterministic(each(|i| {
            self.0.get(first + i).copied().unwrap_or_else(T::zero)
        }))
    }
}
