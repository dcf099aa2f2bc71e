//! A plant whose commands come from its own state, later.

use std::collections::VecDeque;

use crate::analysis::{Feedback, Latency};
use crate::system::Held;
use crate::{Float, Integrator, State, System};

/// The commands on their way, from the one that acts now to the latest: part of the state of a loop.
#[derive(Clone, Debug, PartialEq)]
pub struct Waiting<T, const D: usize>(VecDeque<[T; D]>);

/// A plant under state feedback whose command arrives late and is held until the next one does.
///
/// At the beginning of each step a command is computed from the state there. With a latency of `n` whole steps
/// and a part `f` of another, the step takes `f·Δt` with the command of `n + 1` steps ago and the rest with that of `n`
/// steps ago: it splits where the command arrives.
#[derive(Clone, Debug)]
pub struct ControlLoop<Sys, I, T, const D: usize> {
    system: Sys,
    integrator: I,
    feedback: Feedback,
    part: T,
    state: State<T, D>,
    waiting: Waiting<T, D>,
    step: u64,
}

impl<Sys, I, T, const D: usize> ControlLoop<Sys, I, T, D>
where
    Sys: System<T, D> + Copy,
    I: Integrator,
    T: Float,
{
    /// A loop from `state`; until the first command arrives, `before` acts.
    pub fn new(
        system: Sys,
        integrator: I,
        feedback: Feedback,
        latency: Latency,
        state: State<T, D>,
        before: [T; D],
    ) -> Self {
        let (whole, part) = (latency.steps().trunc(), latency.steps().fract());
        let places = whole as usize + usize::from(part > 0.0);
        let waiting = Waiting(core::iter::repeat_n(before, places).collect());
        let part = T::from_f64(part);
        ControlLoop { system, integrator, feedback, part, state, waiting, step: 0 }
    }

    /// Takes a step of `dt` seconds.
    pub fn advance(&mut self, dt: T) {
        let gains = [self.feedback.position, self.feedback.velocity].map(T::from_f64);
        let State { q, v } = self.state;
        self.waiting.0.push_back(core::array::from_fn(|i| -(gains[0] * q[i]) - gains[1] * v[i]));
        let old = self.waiting.0.pop_front();
        let under = |command: Option<[T; D]>, state, dt| {
            let command = command.unwrap_or([T::zero(); D]);
            self.integrator.step(&Held { system: self.system, command }, state, dt)
        };
        self.state = if self.part == T::zero() {
            under(old, self.state, dt)
        } else {
            let before = self.part * dt;
            let state = under(old, self.state, before);
            under(self.waiting.0.front().copied(), state, dt - before)
        };
        self.step += 1;
    }

    /// The state.
    pub fn state(&self) -> &State<T, D> {
        &self.state
    }

    /// The commands on their way.
    pub fn waiting(&self) -> &Waiting<T, D> {
        &self.waiting
    }

    /// Number of steps taken.
    pub fn step(&self) -> u64 {
        self.step
    }

    /// Goes on from another point of such a loop: its state, the commands that were on their way, its step.
    ///
    /// # Panics
    /// If there are more or fewer commands than the latency has places for.
    pub fn restore(&mut self, state: State<T, D>, waiting: Waiting<T, D>, step: u64) {
        assert_eq!(waiting.0.len(), self.waiting.0.len(), "commands on their way");
        (self.state, self.waiting, self.step) = (state, waiting, step);
    }
}
