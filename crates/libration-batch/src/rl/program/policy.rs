//! Policies of environments by programs.

use libration_core::random::Streams;
use libration_core::{Elementary, Float};

use crate::rl::block_size::LANES;
use crate::rl::policy::{Network, all_finite, random};
use crate::rl::{EnvironmentError, StepIndex};

/// A policy for any number of observations and actions: the policies of [`policy`](crate::rl::policy) with sizes that are known
/// when the program runs, and their bits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ProgramPolicy<'a, T> {
    /// Actions for a whole horizon: `[t, n, i]`.
    ActionSequence(&'a [T]),
    /// An action for all environments and steps: `[i]`.
    Constant(&'a [f64]),
    /// `u = W·seen + b`.
    Linear {
        /// `W`, a row for each action.
        weights: &'a [f64],
        /// `b`, a number for each action.
        bias: &'a [f64],
    },
    /// Uniform between two ends of each action, drawn by address.
    Random {
        /// The lower ends.
        low: &'a [f64],
        /// The upper ends.
        high: &'a [f64],
    },
    /// A multilayer perceptron.
    Network(Network<'a, T>),
}

impl<T: Float + Elementary> ProgramPolicy<'_, T> {
    /// Checks the parameters for `observations` observations and `actions` actions of each environment.
    ///
    /// # Errors
    /// The first invalid parameter.
    pub(super) fn check(
        &self,
        [observations, actions]: [usize; 2],
        [environments, horizon]: [usize; 2],
    ) -> Result<(), EnvironmentError> {
        let shape = EnvironmentError::shape;
        match *self {
            ProgramPolicy::ActionSequence(all) => {
                let wanted = environments.saturating_mul(horizon).saturating_mul(actions);
                shape("actions", all.len(), wanted)
            }
            ProgramPolicy::Constant(action) => {
                shape("numbers of the constant action", action.len(), actions)?;
                all_finite::<T>("constant action", action.iter().copied())
            }
            ProgramPolicy::Linear { weights, bias } => {
                let wanted = observations.saturating_mul(actions);
                shape("weights of the policy", weights.len(), wanted)?;
                shape("biases of the policy", bias.len(), actions)?;
                all_finite::<T>("weight of the policy", weights.iter().copied())?;
                all_finite::<T>("bias of the policy", bias.iter().copied())
            }
            ProgramPolicy::Random { low, high } => {
                shape("lower ends of the random action", low.len(), actions)?;
                shape("upper ends of the random action", high.len(), actions)?;
                random::check::<T>(low, high)
            }
            ProgramPolicy::Network(network) => network.check_sizes(observations, actions),
        }
    }

    /// Whether actions depend on observations.
    pub(super) fn uses_observations(&self) -> bool {
        matches!(self, ProgramPolicy::Linear { .. } | ProgramPolicy::Network(_))
    }

    /// Multiplications and additions of an action.
    pub(super) fn operations(&self) -> u64 {
        match self {
            ProgramPolicy::Linear { weights, .. } => 2 * weights.len() as u64,
            ProgramPolicy::Network(network) => network.work(),
            ProgramPolicy::ActionSequence(_)
            | ProgramPolicy::Constant(_)
            | ProgramPolicy::Random { .. } => 0,
        }
    }

    /// The number of random words per step.
    pub(super) fn words(&self) -> usize {
        match self {
            ProgramPolicy::Random { low, .. } => low.len(),
            _ => 0,
        }
    }

    /// The actions of a block and the logarithms of their probability densities.
    pub(super) fn act(
        &self,
        place: StepIndex,
        seen: &[[T; LANES]],
        words: &mut Streams<LANES>,
        actions: &mut [[T; LANES]],
        log_probabilities: &mut [T; LANES],
    ) {
        *log_probabilities = [T::zero(); LANES];
        match *self {
            ProgramPolicy::ActionSequence(all) => {
                let first = (place.row * place.environments + place.environment) * actions.len();
                let rest = &all[first.min(all.len())..];
                let width = actions.len();
                if let [row] = &mut *actions {
                    let count = rest.len().min(LANES);
                    row[..count].copy_from_slice(&rest[..count]);
                    return;
                }
                // Lanes beyond the last environment find nothing.
                for (i, row) in actions.iter_mut().enumerate() {
                    let numbers = rest.iter().skip(i).step_by(width);
                    row.iter_mut().zip(numbers).for_each(|(to, &x)| *to = x);
                }
            }
            ProgramPolicy::Constant(action) => {
                actions.iter_mut().zip(action).for_each(|(row, &x)| *row = [T::from_f64(x); LANES]);
            }
            ProgramPolicy::Linear { weights, bias } => {
                for (i, (row, &bias)) in actions.iter_mut().zip(bias).enumerate() {
                    *row = [T::from_f64(bias); LANES];
                    for (&weight, seen) in weights[i * seen.len()..].iter().zip(seen) {
                        let weight = T::from_f64(weight);
                        row.iter_mut().zip(seen).for_each(|(sum, &x)| *sum = *sum + weight * x);
                    }
                }
            }
            ProgramPolicy::Random { low, high } => {
                for ((row, &low), &high) in actions.iter_mut().zip(low).zip(high) {
                    for (l, x) in row.iter_mut().enumerate() {
                        *x = random::between(low, high, words.next(l));
                    }
                }
                *log_probabilities = [T::from_f64(random::log_probability(low, high)); LANES];
            }
            ProgramPolicy::Network(network) => network.forward(seen, actions),
        }
    }
}
