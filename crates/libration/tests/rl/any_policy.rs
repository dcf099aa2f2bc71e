//! A policy chosen at run time: environments are compiled once for all of them.

use libration::random::Streams;
use libration::rl::policy::{
    ActionSequence, Constant, GaussianExploration, Linear, LinearPerEnvironment, Perceptron,
    PerceptronPerEnvironment, Random,
};
use libration::rl::{ActionSample, EnvironmentError, Policy, StepIndex};

/// One of the engine's policies for two observations and one action.
#[derive(Clone, Copy, Debug)]
pub(crate) enum AnyPolicy<'a> {
    Constant(Constant<1>),
    Exploration(GaussianExploration<Linear<2, 1>, 1>),
    Linear(Linear<2, 1>),
    LinearPerEnvironment(LinearPerEnvironment<'a, f32>),
    Network(Perceptron<'a, f32, 8>),
    NetworkPerEnvironment(PerceptronPerEnvironment<'a, f32, 8>),
    Random(Random<1>),
    Sequence(ActionSequence<'a, f32>),
}

impl AnyPolicy<'_> {
    pub(crate) fn constant(action: f64) -> Self {
        AnyPolicy::Constant(Constant([action]))
    }

    pub(crate) fn random(low: f64, high: f64) -> Self {
        AnyPolicy::Random(Random::between([low], [high]))
    }
}

/// Actions as they are given.
pub(crate) fn sequence(actions: &[f32]) -> AnyPolicy<'_> {
    AnyPolicy::Sequence(ActionSequence(actions))
}

/// Calls the same method of the policy of any variant.
macro_rules! with {
    ($policy:expr, $chosen:ident => $work:expr) => {
        match $policy {
            AnyPolicy::Constant($chosen) => $work,
            AnyPolicy::Exploration($chosen) => $work,
            AnyPolicy::Linear($chosen) => $work,
            AnyPolicy::LinearPerEnvironment($chosen) => $work,
            AnyPolicy::Network($chosen) => $work,
            AnyPolicy::NetworkPerEnvironment($chosen) => $work,
            AnyPolicy::Random($chosen) => $work,
            AnyPolicy::Sequence($chosen) => $work,
        }
    };
}

impl Policy<f32, 2, 1> for AnyPolicy<'_> {
    const DRAWS: bool = true;

    fn check(&self, environments: usize, horizon: usize) -> Result<(), EnvironmentError> {
        with!(self, policy => Policy::<f32, 2, 1>::check(policy, environments, horizon))
    }

    fn uses_observations(&self) -> bool {
        with!(self, policy => Policy::<f32, 2, 1>::uses_observations(policy))
    }

    fn words(&self) -> usize {
        with!(self, policy => Policy::<f32, 2, 1>::words(policy))
    }

    #[inline(always)]
    fn act(
        &self,
        place: StepIndex,
        seen: &[f32; 2],
        word: &mut impl FnMut() -> u32,
    ) -> ActionSample<f32, 1> {
        with!(self, policy => policy.act(place, seen, word))
    }

    /// The match is outside the loop over lanes.
    #[inline(always)]
    fn act_all<const W: usize>(
        &self,
        place: StepIndex,
        seen: &[[f32; W]; 2],
        words: &mut Streams<W>,
        actions: &mut [[f32; W]; 1],
        log_probabilities: &mut [f32; W],
    ) {
        with!(self, policy => policy.act_all(place, seen, words, actions, log_probabilities));
    }
}
