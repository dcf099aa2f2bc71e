//! Copies of states.

use core::ops::Range;

use libration_core::State;

use super::{Lanes, Observer};

/// Keeps the states of trajectories at every observed step.
///
/// It stores as many states as observed steps times trajectories: observe long runs rarely.
#[derive(Clone, Debug, PartialEq)]
pub struct Copies<T, const D: usize> {
    trajectories: Range<usize>,
    steps: Vec<u64>,
    /// The states of the first trajectory at all steps, then those of the second.
    states: Vec<Vec<State<T, D>>>,
}

impl<T, const D: usize> Copies<T, D> {
    /// An observer for `trajectories`.
    pub fn new(trajectories: Range<usize>) -> Self {
        let states = trajectories.clone().map(|_| Vec::new()).collect();
        Copies { trajectories, steps: Vec::new(), states }
    }

    /// The trajectories.
    pub fn trajectories(&self) -> Range<usize> {
        self.trajectories.clone()
    }

    /// The numbers of the observed steps, in increasing order.
    pub fn steps(&self) -> &[u64] {
        &self.steps
    }

    /// The states of trajectory `n` of the ensemble at these steps; none if it is not among these.
    pub fn states(&self, n: usize) -> Option<&[State<T, D>]> {
        let own = n.checked_sub(self.trajectories.start)?;
        self.states.get(own).map(Vec::as_slice)
    }
}

impl<T: Copy + Send + Sync, const D: usize> Observer<T, D> for Copies<T, D> {
    fn observe(&mut self, lanes: &Lanes<'_, T, D>) {
        // Blocks come one after the other, and each goes through the same steps.
        if lanes.first == self.trajectories.start {
            self.steps.push(lanes.step);
        }
        for l in 0..lanes.len() {
            self.states[lanes.first - self.trajectories.start + l].push(lanes.state(l));
        }
    }
}
