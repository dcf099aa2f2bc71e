//! Everything there is to know of loops at a step.

use crate::State;

/// States, and all that is remembered: what clocks, delays and controllers keep, and the commands on their way.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapshot<T, const D: usize> {
    pub(super) step: u64,
    pub(super) states: Vec<State<T, D>>,
    pub(super) memories: Vec<T>,
}

impl<T, const D: usize> Snapshot<T, D> {
    /// Number of steps taken.
    pub fn step(&self) -> u64 {
        self.step
    }

    /// The state of each trajectory.
    pub fn states(&self) -> &[State<T, D>] {
        &self.states
    }
}
