//! Who acts, chosen when the program runs.

use libration::random::Streams;
use libration::rl::policy::{ActionSequence, Constant, Linear, Network, Random};
use libration::rl::{ActionSample, EnvironmentError, Policy, StepIndex};
use libration::{Elementary, Float};

/// A policy, and its numbers.
#[derive(Clone, Debug, PartialEq)]
pub enum Acting {
    /// The sum of what is seen, each times its weight, and a bias.
    Linear {
        /// One for each number that is seen.
        weights: Vec<f64>,
        /// What is added.
        bias: f64,
    },
    /// Uniform between two ends.
    Random {
        /// The lower one.
        low: f64,
        /// The upper one.
        high: f64,
    },
    /// Always the same.
    Constant(f64),
}

impl Acting {
    /// Its name in files of settings.
    pub fn name(&self) -> &'static str {
        match self {
            Acting::Linear { .. } => "linear",
            Acting::Random { .. } => "random",
            Acting::Constant(_) => "constant",
        }
    }
}

/// One of the engine's policies. What it computes is theirs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Actor<'a, T, const O: usize> {
    /// See [`Linear`].
    Linear(Linear<O, 1>),
    /// See [`Random`].
    Random(Random<1>),
    /// See [`Constant`].
    Constant(Constant<1>),
    /// See [`ActionSequence`].
    Given(ActionSequence<'a, T>),
    /// See [`Network`].
    Network(Network<'a, T>),
}

impl<T, const O: usize> Actor<'_, T, O> {
    /// Of these numbers: weights that are missing are 0.
    pub fn new(acting: &Acting) -> Self {
        match acting {
            Acting::Linear { weights, bias } => {
                let weights = core::array::from_fn(|i| weights.get(i).copied().unwrap_or(0.0));
                Actor::Linear(Linear { weights: [weights], bias: [*bias] })
            }
            Acting::Random { low, high } => Actor::Random(Random::between([*low], [*high])),
            Acting::Constant(action) => Actor::Constant(Constant([*action])),
        }
    }
}

/// Does something with the policy that it is.
macro_rules! with {
    ($actor:expr, $policy:ident => $work:expr) => {
        match $actor {
            Actor::Linear($policy) => $work,
            Actor::Random($policy) => $work,
            Actor::Constant($policy) => $work,
            Actor::Given($policy) => $work,
            Actor::Network($policy) => $work,
        }
    };
}

impl<T: Float + Elementary, const O: usize> Policy<T, O, 1> for Actor<'_, T, O> {
    const DRAWS: bool = true;

    fn check(&self, environments: usize, horizon: usize) -> Result<(), EnvironmentError> {
        with!(self, policy => Policy::<T, O, 1>::check(policy, environments, horizon))
    }

    fn uses_observations(&self) -> bool {
        with!(self, policy => Policy::<T, O, 1>::uses_observations(policy))
    }

    fn words(&self) -> usize {
        with!(self, policy => Policy::<T, O, 1>::words(policy))
    }

    #[inline(always)]
    fn act(
        &self,
        place: StepIndex,
        seen: &[T; O],
        word: &mut impl FnMut() -> u32,
    ) -> ActionSample<T, 1> {
        with!(self, policy => policy.act(place, seen, word))
    }

    /// Whoever it is, its loop knows nobody else.
    #[inline(always)]
    fn act_all<const W: usize>(
        &self,
        place: StepIndex,
        seen: &[[T; W]; O],
        words: &mut Streams<W>,
        actions: &mut [[T; W]; 1],
        log_probabilities: &mut [T; W],
    ) {
        with!(self, policy => policy.act_all(place, seen, words, actions, log_probabilities));
    }
}
