//! What is seen of an ensemble while it runs.

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
    /// Takes note of neighbouring trajectories at one step.
    ///
    /// It is compiled for the instruction set of the ensemble if it is `#[inline(always)]`.
    fn observe(&mut self, lanes: &Lanes<'_, T, D>);
}
