//! What is seen, paid, and over.

use libration::rl::task::{Regulate, Sine, SwingUp, Track};

/// One of the engine's tasks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Task {
    /// To rest at the origin.
    Regulate(Regulate),
    /// To stand a pendulum on its head.
    SwingUp(SwingUp),
    /// To follow a sine.
    Track(Track<Sine>),
}

/// What a number is that is seen.
#[derive(Clone, Copy)]
pub(super) enum Seen {
    Position,
    Velocity,
    Neither,
}

impl Task {
    /// Its name in files of settings.
    pub fn name(&self) -> &'static str {
        match self {
            Task::Regulate(_) => "regulate",
            Task::SwingUp(_) => "swing-up",
            Task::Track(_) => "track",
        }
    }

    /// Names of what is seen, and what each is.
    pub(super) fn seen(&self) -> &'static [(&'static str, Seen)] {
        use Seen::{Neither, Position, Velocity};
        const STATE: [(&str, Seen); 4] = [
            ("q0", Position),
            ("v0", Velocity),
            ("reference_q0", Position),
            ("reference_v0", Velocity),
        ];
        match self {
            Task::Regulate(_) => &STATE[..2],
            Task::SwingUp(_) => &[("cos_q0", Neither), ("sin_q0", Neither), ("v0", Velocity)],
            Task::Track(_) => &STATE,
        }
    }

    /// How many numbers are seen.
    pub fn observations(&self) -> usize {
        self.seen().len()
    }
}
