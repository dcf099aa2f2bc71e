//! The largest drift of the energy.

use core::marker::PhantomData;
use core::ops::Range;

use libration_core::{Float, Hamiltonian};

use super::super::Assign;
use super::{Lanes, Observer};

/// Keeps, for every trajectory, the largest change `|E − E₀|` of its energy at the observed steps,
/// where `E₀` is its energy at the first observation.
#[derive(Clone, Debug)]
pub struct Drift<T, Sys, A> {
    first: usize,
    systems: A,
    start: Vec<T>,
    change: Vec<T>,
    system: PhantomData<Sys>,
}

impl<T: Float, Sys, A> Drift<T, Sys, A> {
    /// An observer for `trajectories` of `systems`.
    pub fn new(trajectories: Range<usize>, systems: A) -> Self {
        let count = trajectories.len();
        Drift {
            first: trajectories.start,
            systems,
            start: Vec::with_capacity(count),
            change: vec![T::zero(); count],
            system: PhantomData,
        }
    }

    /// The largest `|E − E₀|/|E₀|` of each trajectory, in order: not a number once an energy was none,
    /// and where `E₀` and all changes are zero.
    pub fn largest(&self) -> impl Iterator<Item = f64> + '_ {
        let pairs = self.change.iter().zip(&self.start);
        pairs.map(|(change, start)| change.to_f64() / start.to_f64().abs())
    }
}

impl<T, Sys, A, const D: usize> Observer<T, D> for Drift<T, Sys, A>
where
    T: Float,
    Sys: Hamiltonian<T, D> + Send,
    A: Assign<Sys>,
{
    #[inline(always)]
    fn observe(&mut self, lanes: &Lanes<'_, T, D>) {
        let at = lanes.first - self.first;
        let energy = |l: usize| self.systems.of(lanes.first + l).energy(&lanes.state(l));
        // Blocks come one after the other: a block that is new begins where those before it ended.
        if at == self.start.len() {
            self.start.extend((0..lanes.len()).map(energy));
        }
        let start = &self.start[at..at + lanes.len()];
        let largest = &mut self.change[at..at + lanes.len()];
        for l in 0..lanes.len() {
            let change = energy(l) - start[l];
            let change = if change < T::zero() { -change } else { change };
            // What is not a number stays: nothing is larger.
            if change > largest[l] || is_nan(change) {
                largest[l] = change;
            }
        }
    }
}

#[inline(always)]
fn is_nan<T: PartialOrd>(x: T) -> bool {
    x.partial_cmp(&x).is_none()
}
