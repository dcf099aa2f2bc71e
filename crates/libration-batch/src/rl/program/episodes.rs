//! Episodes without states: what [`Environments`] has of each environment besides positions and velocities.

use libration_core::{Float, Scalar, State, System};

use super::environment::World;
use crate::rl::block::BlockOf;
use crate::rl::{Environments, Episode, Start, Task};

/// Episodes, clocks and latencies of environments.
pub(super) type Episodes<T> = Environments<T, World, 0, 0>;

/// A block of episodes.
pub(super) type EpisodeBlock<T> = BlockOf<T, World, 0, 0>;

/// A system without degrees of freedom.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct NoSystem;

impl<S: Scalar> System<S, 0> for NoSystem {
    fn acceleration(&self, _: &State<S, 0>) -> [S; 0] {
        []
    }
}

/// A task that observes nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct NoTask;

impl<T: Float> Task<T, 0, 0> for NoTask {
    fn observe(&self, _: T, _: &State<T, 0>) -> [T; 0] {
        []
    }

    fn reward(&self, _: T, _: &State<T, 0>, _: &[T; 0], _: &State<T, 0>) -> T {
        T::zero()
    }

    fn terminated(&self, _: T, _: &State<T, 0>) -> bool {
        false
    }
}

/// The start of a state without coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct NoStart;

impl<T: Float> Start<T, 0> for NoStart {
    fn draw(&self, _: Episode) -> State<T, 0> {
        State { q: [], v: [] }
    }
}
