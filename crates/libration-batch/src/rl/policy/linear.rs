//! Linear feedback.

use libration_core::Float;
use libration_core::array::each;
use libration_core::random::Streams;

use super::{ActionSample, Policy, StepIndex, all_finite, lanes};
use crate::rl::EnvironmentError;

/// `u = W·seen + b`: proportional-derivative control, LQR.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Linear<const O: usize, const D: usize> {
    /// `W`, row by row: a row for each degree of freedom.
    pub weights: [[f64; O]; D],
    /// `b`.
    pub bias: [f64; D],
}

impl<T: Float, const O: usize, const D: usize> Policy<T, O, D> for Linear<O, D> {
    const CLOSED_FORM: bool = true;

    fn check(&self, _: usize, _: usize) -> Result<(), EnvironmentError> {
        all_finite::<T>("weight of the policy", self.weights.as_flattened().iter().copied())?;
        all_finite::<T>("bias of the policy", self.bias)
    }

    #[inline(always)]
    fn act(&self, _: StepIndex, seen: &[T; O], _: &mut impl FnMut() -> u32) -> ActionSample<T, D> {
        ActionSample::deterministic(each(|i| {
            let mut sum = T::from_f64(self.bias[i]);
            for (weight, &x) in self.weights[i].iter().zip(seen) {
                sum = sum + T::from_f64(*weight) * x;
            }
            sum
        }))
    }
}

/// [`Linear`] with weights for each environment, as evolution strategies want: `[k, n]`, where number `k` of environment `n` is
/// that of `O` weights and a bias for each degree of freedom in turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearPerEnvironment<'a, T>(
    /// The weights.
    pub &'a [T],
);

impl<T: Float, const O: usize, const D: usize> Policy<T, O, D> for LinearPerEnvironment<'_, T> {
    fn check(&self, environments: usize, _: usize) -> Result<(), EnvironmentError> {
        let wanted = environments.saturating_mul(D * (O + 1));
        EnvironmentError::shape("weights of the policy", self.0.len(), wanted)?;
        all_finite::<T>("weight of the policy", self.0.iter().map(|x| x.to_f64()))
    }

    #[inline(always)]
    fn act(
        &self,
        place: StepIndex,
        seen: &[T; O],
        _: &mut impl FnMut() -> u32,
    ) -> ActionSample<T, D> {
        let number = |k: usize| self.0[k * place.environments + place.environment];
        ActionSample::deterministic(each(|i| {
            let mut sum = number(i * (O + 1) + O);
            for (k, &x) in seen.iter().enumerate() {
                sum = sum + number(i * (O + 1) + k) * x;
            }
            sum
        }))
    }

    #[inline(always)]
    fn act_all<const W: usize>(
        &self,
        place: StepIndex,
        seen: &[[T; W]; O],
        _: &mut Streams<W>,
        actions: &mut [[T; W]; D],
        _: &mut [T; W],
    ) {
        let row = |k| lanes::<T, W>(self.0, place, k);
        for (i, action) in actions.iter_mut().enumerate() {
            *action = row(i * (O + 1) + O);
            for (k, seen) in seen.iter().enumerate() {
                let weight = row(i * (O + 1) + k);
                for l in 0..W {
                    action[l] = action[l] + weight[l] * seen[l];
                }
            }
        }
    }
}
