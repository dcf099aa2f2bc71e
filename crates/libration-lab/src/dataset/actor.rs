//! Who acts in a data set, chosen when the program runs.

use libration::Float;
use libration::rl::policy::{Constant, Linear, Random};
use libration::rl::{Act, EnvironmentError, Place, Policy};

use super::settings::Acting;

/// One of the engine's policies. What it computes is theirs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Actor<const O: usize> {
    Linear(Linear<O, 1>),
    Random(Random<1>),
    Constant(Constant<1>),
}

impl<const O: usize> Actor<O> {
    pub(super) fn new(acting: &Acting) -> Self {
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

impl<T: Float, const O: usize> Policy<T, O, 1> for Actor<O> {
    const DRAWS: bool = true;

    fn check(&self, environments: usize, horizon: usize) -> Result<(), EnvironmentError> {
        match self {
            Actor::Linear(policy) => Policy::<T, O, 1>::check(policy, environments, horizon),
            Actor::Random(policy) => Policy::<T, O, 1>::check(policy, environments, horizon),
            Actor::Constant(policy) => Policy::<T, O, 1>::check(policy, environments, horizon),
        }
    }

    /// As many as the one that draws takes.
    fn words(&self) -> usize {
        1
    }

    #[inline(always)]
    fn act(&self, place: Place, seen: &[T; O], word: &mut impl FnMut() -> u32) -> Act<T, 1> {
        match self {
            Actor::Linear(policy) => policy.act(place, seen, word),
            Actor::Random(policy) => policy.act(place, seen, word),
            Actor::Constant(policy) => policy.act(place, seen, word),
        }
    }
}
