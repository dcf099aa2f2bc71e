//! Policies chosen at run time.

use libration::random::Streams;
use libration::rl::policy::{ActionSequence, Constant, Linear, Network, Random};
use libration::rl::{ActionSample, EnvironmentError, Policy, StepIndex};
use libration::{Elementary, Float};

/// A policy with its parameters.
#[derive(Clone, Debug, PartialEq)]
pub enum PolicySettings {
    /// The weighted sum of the observations plus a bias.
    Linear {
        /// One weight per observation.
        weights: Vec<f64>,
        /// The bias.
        bias: f64,
    },
    /// Uniform random actions.
    Random {
        /// The lower end.
        low: f64,
        /// The upper end.
        high: f64,
    },
    /// A constant action.
    Constant(f64),
}

impl PolicySettings {
    /// The name in settings files.
    pub fn name(&self) -> &'static str {
        match self {
            PolicySettings::Linear { .. } => "linear",
            PolicySettings::Random { .. } => "random",
            PolicySettings::Constant(_) => "constant",
        }
    }
}

/// One of the engine's policies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AnyPolicy<'a, T, const O: usize> {
    /// See [`Linear`].
    Linear(Linear<O, 1>),
    /// See [`Random`].
    Random(Random<1>),
    /// See [`Constant`].
    Constant(Constant<1>),
    /// See [`ActionSequence`].
    ActionSequence(ActionSequence<'a, T>),
    /// See [`Network`].
    Network(Network<'a, T>),
}

impl<T, const O: usize> AnyPolicy<'_, T, O> {
    /// The policy of these settings; missing weights are 0.
    pub fn new(acting: &PolicySettings) -> Self {
        match acting {
            PolicySettings::Linear { weights, bias } => {
                let weights = core::array::from_fn(|i| weights.get(i).copied().unwrap_or(0.0));
                AnyPolicy::Linear(Linear { weights: [weights], bias: [*bias] })
            }
            PolicySettings::Random { low, high } => {
                AnyPolicy::Random(Random::between([*low], [*high]))
            }
            PolicySettings::Constant(action) => AnyPolicy::Constant(Constant([*action])),
        }
    }
}

/// Calls the same method of the policy of any variant.
macro_rules! with {
    ($actor:expr, $policy:ident => $work:expr) => {
        match $actor {
            AnyPolicy::Linear($policy) => $work,
            AnyPolicy::Random($policy) => $work,
            AnyPolicy::Constant($policy) => $work,
            AnyPolicy::ActionSequence($policy) => $work,
            AnyPolicy::Network($policy) => $work,
        }
    };
}

impl<T: Float + Elementary, const O: usize> Policy<T, O, 1> for AnyPolicy<'_, T, O> {
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

    /// The match is outside the loop over lanes.
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
