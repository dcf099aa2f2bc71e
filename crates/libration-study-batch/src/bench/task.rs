//! The ensemble that a measurement of speed runs.

/// Trajectories, system and time step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Task {
    /// Number of trajectories.
    pub(crate) count: usize,
    /// `ω²`.
    pub(crate) omega2: f64,
    /// The time step, in s.
    pub(crate) dt: f64,
}

impl Task {
    /// Position and velocity from which trajectory `n` starts: each elsewhere, so that none can be
    /// left out.
    pub(super) fn start(&self, n: usize) -> [f64; 2] {
        let share = n as f64 / self.count as f64;
        [1.0 + share, 0.5 - share]
    }
}
