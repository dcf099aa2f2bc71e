//! Policies.

mod action_sequence;
mod exploration;
mod linear;
mod network;
mod perceptron;
pub(in crate::rl) mod random;

pub use action_sequence::ActionSequence;
pub use exploration::GaussianExploration;
pub use linear::{Linear, LinearPerEnvironment};
pub use network::Network;
pub use perceptron::{Activation, Perceptron, PerceptronPerEnvironment};
pub use random::Random;

use libration_core::Float;
use libration_core::array::{each, map};
use libration_core::control::ControlError;
use libration_core::random::Streams;

use super::EnvironmentError;
use crate::ensemble::kernel::{at, put};

/// A policy: computes an action, an acceleration in each of `D` degrees of freedom, from `O` observed numbers.
pub trait Policy<T: Float, const O: usize, const D: usize>: Copy + Send + Sync {
    /// Whether the action is a short closed-form expression, best computed per environment.
    const CLOSED_FORM: bool = false;
    /// Whether the policy draws random words.
    const DRAWS: bool = false;

    /// Checks the parameters for a number of environments and steps.
    ///
    /// # Errors
    /// The first invalid parameter.
    fn check(&self, environments: usize, horizon: usize) -> Result<(), EnvironmentError> {
        let _ = (environments, horizon);
        Ok(())
    }

    /// Whether actions depend on observations. If not, observations may be skipped.
    fn uses_observations(&self) -> bool {
        true
    }

    /// Multiplications and additions of an action of one of so many environments, besides those of a linear policy.
    fn operations(&self, environments: usize) -> u64 {
        let _ = environments;
        0
    }

    /// The number of random words per action, always the same.
    fn words(&self) -> usize {
        0
    }

    /// The action. An implementation branches on values of `self` only and is `#[inline(always)]`; otherwise the loops over
    /// environments are not vectorised.
    fn act(
        &self,
        place: StepIndex,
        seen: &[T; O],
        word: &mut impl FnMut() -> u32,
    ) -> ActionSample<T, D>;

    /// The actions and their log-probabilities of `W` neighbouring environments, the first of which has this place.
    #[inline(always)]
    fn act_all<const W: usize>(
        &self,
        place: StepIndex,
        seen: &[[T; W]; O],
        words: &mut Streams<W>,
        actions: &mut [[T; W]; D],
        log_probabilities: &mut [T; W],
    ) {
        for (l, log) in log_probabilities.iter_mut().enumerate() {
            let act = self.act(place.lane(l), &at(seen, l), &mut || words.next(l));
            put(actions, l, act.action);
            *log = act.log_probability;
        }
    }
}

/// An action and its log-probability.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ActionSample<T, const D: usize> {
    /// The action.
    pub action: [T; D],
    /// The logarithm of its probability density; 0 where nothing is drawn.
    pub log_probability: T,
}

impl<T: Float, const D: usize> ActionSample<T, D> {
    /// An action without randomness, of log-probability 0.
    #[inline(always)]
    pub fn deterministic(action: [T; D]) -> Self {
        ActionSample { action, log_probability: T::zero() }
    }
}

/// The indices of a step: environment, step and row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StepIndex {
    /// The number of the environment.
    pub environment: usize,
    /// The number of environments.
    pub environments: usize,
    /// Steps since the batch was made.
    pub step: u64,
    /// Steps since the rollout began.
    pub row: usize,
}

impl StepIndex {
    /// The index of the environment `l` numbers further.
    #[inline(always)]
    pub fn lane(self, l: usize) -> Self {
        StepIndex { environment: self.environment + l, ..self }
    }
}

/// A policy with one constant action.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Constant<const D: usize>(
    /// The action.
    pub [f64; D],
);

impl<T: Float, const O: usize, const D: usize> Policy<T, O, D> for Constant<D> {
    const CLOSED_FORM: bool = true;

    fn check(&self, _: usize, _: usize) -> Result<(), EnvironmentError> {
        all_finite::<T>("constant action", self.0)
    }

    fn uses_observations(&self) -> bool {
        false
    }

    #[inline(always)]
    fn act(&self, _: StepIndex, _: &[T; O], _: &mut impl FnMut() -> u32) -> ActionSample<T, D> {
        ActionSample::deterministic(map(self.0, T::from_f64))
    }
}

/// Returns an error unless all numbers are finite, in the float type as well.
pub(in crate::rl) fn all_finite<T: Float>(
    name: &'static str,
    numbers: impl IntoIterator<Item = f64>,
) -> Result<(), EnvironmentError> {
    let mut numbers = numbers.into_iter().enumerate();
    let Some((index, value)) = numbers.find(|&(_, x)| !T::from_f64(x).is_finite()) else {
        return Ok(());
    };
    let allowed = "finite in the float type";
    Err(ControlError { name, index: Some(index), value, allowed }.into())
}

/// Multiplications and additions of a network with these parameters and hidden neurons.
fn network_operations(parameters: usize, neurons: usize, activation: Activation) -> u64 {
    // A hyperbolic tangent is a quotient of polynomials.
    let each = match activation {
        Activation::Tanh => 30,
        Activation::Relu => 1,
    };
    2 * parameters as u64 + each * neurons as u64
}

/// Number `k` of neighbouring environments, from `[k, n]`. Values beyond the last environment are arbitrary.
#[inline(always)]
fn lanes<T: Float, const W: usize>(numbers: &[T], place: StepIndex, k: usize) -> [T; W] {
    let row = &numbers[k * place.environments..][place.environment..place.environments];
    // All at once where there are as many.
    let whole = row.first_chunk().copied();
    whole.unwrap_or_else(|| each(|l| row.get(l).copied().unwrap_or_else(T::zero)))
}
