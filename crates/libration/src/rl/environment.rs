//! What an environment is made of.

/// A system with its integrator, a task, a start and a time limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Environment<A, M, K, S> {
    /// The system of every environment: [`All`](crate::ensemble::All) or [`Each`](crate::ensemble::Each).
    pub systems: A,
    /// The integrator.
    pub method: M,
    /// Its step, in seconds.
    pub dt: f64,
    /// Steps of the integrator for which an action is held; at least 1.
    pub substeps: u32,
    /// What is seen, paid, and over.
    pub task: K,
    /// Where episodes begin.
    pub start: S,
    /// Actions after which an episode is cut off, if it is.
    pub limit: Option<u32>,
}
