//! Tasks of environments, chosen at run time.

use libration::rl::task::{Regulate, Sine, SwingUp, Track};

/// One of the engine's tasks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Task {
    /// Rest at the origin.
    Regulate(Regulate),
    /// Swing a pendulum up.
    SwingUp(SwingUp),
    /// Track a sine.
    Track(Track<Sine>),
}

/// The quantity of an observation.
#[derive(Clone, Copy)]
pub(super) enum ObservedQuantity {
    Position,
    Velocity,
    Dimensionless,
}

impl Task {
    /// The name in settings files.
    pub fn name(&self) -> &'static str {
        match self {
            Task::Regulate(_) => "regulate",
            Task::SwingUp(_) => "swing-up",
            Task::Track(_) => "track",
        }
    }

    /// Names and quantities of the observations.
    pub(super) fn observed(&self) -> &'static [(&'static str, ObservedQuantity)] {
        use ObservedQuantity::{Dimensionless, Position, Velocity};
        const STATE: [(&str, ObservedQuantity); 4] = [
            ("q0", Position),
            ("v0", Velocity),
            ("reference_q0", Position),
            ("reference_v0", Velocity),
        ];
        match self {
            Task::Regulate(_) => &STATE[..2],
            Task::SwingUp(_) => {
                &[("cos_q0", Dimensionless), ("sin_q0", Dimensionless), ("v0", Velocity)]
            }
            Task::Track(_) => &STATE,
        }
    }

    /// The number of observations.
    pub fn observations(&self) -> usize {
        self.observed().len()
    }
}
