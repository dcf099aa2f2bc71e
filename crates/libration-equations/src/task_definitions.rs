//! A task as its author writes it.

use super::Definitions;

/// The task of environments of a system as its author writes it.
///
/// Expressions have the names of the system, and `t` for the time since the episode began.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TaskDefinitions {
    /// The observed numbers: expressions of a state.
    pub observe: Vec<String>,
    /// The reward of a step: an expression of the state after it, the inputs during it, and by `before(x)` of the state before it.
    pub reward: String,
    /// Comparisons of expressions of the state after a step, one of which ends an episode.
    pub terminated: Vec<String>,
    /// States by name, and what each step of the integrator replaces them by: expressions of the state after it, of the inputs, of the
    /// length `dt` of the step in seconds, and by `before(x)` of the state before it.
    pub project: Vec<(String, String)>,
    /// The names of actions that are targets of an inner controller; empty where actions are the inputs of the system.
    pub targets: Vec<String>,
    /// Inputs by name, and the command of the inner controller: an expression of the state, of targets, and of `age`, the time in s since
    /// the observation to which the targets respond.
    pub inner: Vec<(String, String)>,
}

impl TaskDefinitions {
    /// The names of the actions on a system.
    pub fn actions<'a>(&'a self, definitions: &'a Definitions) -> &'a [String] {
        if self.targets.is_empty() { &definitions.inputs } else { &self.targets }
    }
}
