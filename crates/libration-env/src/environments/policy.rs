//! Policies chosen at run time.

use libration::random::Streams;
use libration::rl::policy::{ActionSequence, Constant, Linear, Network, Random};
use libration::rl::{ActionSample, EnvironmentError, Policy, ProgramPolicy, StepIndex};
use libration::{Elementary, Float};

/// A policy with its parameters, for any number of observations and actions.
#[derive(Clone, Debug, PartialEq)]
pub enum PolicySettings {
    /// The weighted sum of the observations plus a bias.
    Linear {
        /// One weight per observation, a row for each action.
        weights: Vec<f64>,
        /// The bias of each action.
        bias: Vec<f64>,
    },
    /// Uniform random actions.
    Random {
        /// The lower ends.
        low: Vec<f64>,
        /// The upper ends.
        high: Vec<f64>,
    },
    /// A constant action.
    Constant(Vec<f64>),
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

    /// The policy of the engine.
    pub fn policy<T>(&self) -> ProgramPolicy<'_, T> {
        match self {
            PolicySettings::Linear { weights, bias } => ProgramPolicy::Linear { weights, bias },
            PolicySettings::Random { low, high } => ProgramPolicy::Random { low, high },
            PolicySettings::Constant(action) => ProgramPolicy::Constant(action),
        }
    }
}

/// One of the engine's policies for `O` observations and one action.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum SizedPolicy<'a, T, const O: usize> {
    Linear(Linear<O, 1>),
    Random(Random<1>),
    Constant(Constant<1>),
    ActionSequence(ActionSequence<'a, T>),
    Network(Network<'a, T>),
}

impl<'a, T, const O: usize> SizedPolicy<'a, T, O> {
    /// The same policy for these sizes.
    ///
    /// # Errors
    /// If it is for others.
    pub(super) fn new(policy: ProgramPolicy<'a, T>) -> Result<Self, EnvironmentError> {
        fn exactly<const N: usize>(
            name: &'static str,
            numbers: &[f64],
        ) -> Result<[f64; N], EnvironmentError> {
            let error = EnvironmentError::Shape { name, found: numbers.len(), wanted: N };
            numbers.try_into().map_err(|_| error)
        }
        Ok(match policy {
            ProgramPolicy::Linear { weights, bias } => SizedPolicy::Linear(Linear {
                weights: [exactly("weights of the policy", weights)?],
                bias: exactly("biases of the policy", bias)?,
            }),
            ProgramPolicy::Random { low, high } => SizedPolicy::Random(Random::between(
                exactly("lower ends of the random action", low)?,
                exactly("upper ends of the random action", high)?,
            )),
            ProgramPolicy::Constant(action) => {
                SizedPolicy::Constant(Constant(exactly("numbers of the constant action", action)?))
            }
            ProgramPolicy::ActionSequence(actions) => {
                SizedPolicy::ActionSequence(ActionSequence(actions))
            }
            ProgramPolicy::Network(network) => SizedPolicy::Network(network),
        })
    }
}

/// Calls the same method of the policy of any variant.
macro_rules! with {
    ($actor:expr, $policy:ident => $work:expr) => {
        match $actor {
            SizedPolicy::Linear($policy) => $work,
            SizedPolicy::Random($policy) => $work,
            SizedPolicy::Constant($policy) => $work,
            SizedPolicy::ActionSequence($policy) => $work,
            SizedPolicy::Network($policy) => $work,
        }
    };
}

impl<T: Float + Elementary, const O: usize> Policy<T, O, 1> for SizedPolicy<'_, T, O> {
    const DRAWS: bool = true;

    fn check(&self, environments: usize, horizon: usize) -> Result<(), EnvironmentError> {
        with!(self, policy => Policy::<T, O, 1>::check(policy, environments, horizon))
    }

    fn uses_observations(&self) -> bool {
        with!(self, policy => Policy::<T, O, 1>::uses_observations(policy))
    }

    fn operations(&self, environments: usize) -> u64 {
        with!(self, policy => Policy::<T, O, 1>::operations(policy, environments))
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
