//! The reference for the kernels: a plain loop of one trajectory.

use std::collections::VecDeque;

use libration::control::{Feedback, Latency};
use libration::system::{CommandedSystem, Oscillator};
use libration::{Integrator, State};

/// An oscillator under feedback of its state with a constant latency.
pub(crate) struct One<M> {
    pub(crate) system: Oscillator<f64>,
    pub(crate) method: M,
    pub(crate) feedback: Feedback,
    part: f64,
    pub(crate) state: State<f64, 1>,
    waiting: VecDeque<f64>,
    held: f64,
}

impl<M: Integrator> One<M> {
    pub(crate) fn new(
        omega2: f64,
        method: M,
        feedback: Feedback,
        latency: Latency,
        state: State<f64, 1>,
    ) -> Self {
        let (whole, part) = (latency.steps().trunc() as usize, latency.steps().fract());
        let waiting = std::iter::repeat_n(0.0, whole).collect();
        let system = Oscillator { omega2 };
        One { system, method, feedback, part, state, waiting, held: 0.0 }
    }

    /// Takes a step of `dt` seconds, which splits where a command arrives within it.
    pub(crate) fn step(&mut self, dt: f64) {
        let State { q: [q], v: [v] } = self.state;
        let Feedback { position, velocity } = self.feedback;
        self.waiting.push_back(-(position * q) - velocity * v);
        let arrives = self.waiting.pop_front().unwrap();
        let before = self.part * dt;
        if self.part > 0.0 {
            self.under_command(before);
        }
        self.held = arrives;
        self.under_command(dt - before);
    }

    /// All that it knows: the state, the command that acts, those on their way.
    pub(crate) fn known(&self) -> Vec<f64> {
        let State { q: [q], v: [v] } = self.state;
        [q, v, self.held].into_iter().chain(self.waiting.iter().copied()).collect()
    }

    /// Sets all that it knows.
    pub(crate) fn set(&mut self, known: Vec<f64>) {
        self.state = State { q: [known[0]], v: [known[1]] };
        self.held = known[2];
        self.waiting = known[3..].iter().copied().collect();
    }

    fn under_command(&mut self, dt: f64) {
        let held = CommandedSystem { system: self.system, command: [self.held] };
        self.state = self.method.step(&held, self.state, dt);
    }
}
