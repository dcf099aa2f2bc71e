//! Observers of an ensemble.
//!
//! [`Copies`] of states, the largest [`Drift`] of the energy, the [`MeanSquareError`] against a known
//! solution, the [`MeanCost`] and [`Moments`] over the trajectories come with the engine; any [`Observer`] may be a
//! user's own.

mod copies;
mod drift;
mod error;
mod mean_cost;
mod moments;

pub use copies::Copies;
pub use drift::Drift;
pub use error::MeanSquareError;
pub use mean_cost::MeanCost;
pub use moments::{Moments, Summary};

use libration_core::State;

/// Neighbouring trajectories at one step.
#[derive(Clone, Copy, Debug)]
pub struct Lanes<'a, T, const D: usize> {
    /// Index of the first of them in the ensemble.
    pub first: usize,
    /// Number of steps taken from the start.
    pub step: u64,
    /// Position `i` of each.
    pub q: [&'a [T]; D],
    /// Velocity `i` of each.
    pub v: [&'a [T]; D],
}

/// Sees trajectories of an ensemble at chosen steps, while they are in the cache.
pub trait Observer<T, const D: usize>: Send {
    /// Whether it observes anything. Kernels without observation are compiled for speed.
    #[doc(hidden)]
    const WATCHES: bool = true;

    /// Takes note of neighbouring trajectories at one step.
    ///
    /// It is compiled for the instruction set of the ensemble if it is `#[inline(always)]`.
    fn observe(&mut self, lanes: &Lanes<'_, T, D>);
}

impl<T: Copy, const D: usize> Lanes<'_, T, D> {
    /// The number of trajectories.
    #[inline(always)]
    pub fn len(&self) -> usize {
        self.q.first().map_or(0, |plane| plane.len())
    }

    /// Whether there are none.
    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The state of the `l`-th of them.
    ///
    /// # Panics
    /// If there are fewer.
    #[inline(always)]
    pub fn state(&self, l: usize) -> State<T, D> {
        State { q: self.q.map(|plane| plane[l]), v: self.v.map(|plane| plane[l]) }
    }
}
