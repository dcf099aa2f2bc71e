//! What environments are made of.

use libration::Method;
use libration::catalog::Actuation;
use libration::control::Jitter;
use libration::rl::{Autoreset, Delays};
use libration_settings::units;
use libration_settings::units::Units;

use super::task::Seen;
use super::{Lone, Task};

/// Everything about an environment but its float type.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Recipe {
    /// Of one degree of freedom.
    pub system: Lone,
    /// The quantity of actions.
    pub actuation: Actuation,
    /// The integrator.
    pub method: Method,
    /// Its step, in seconds.
    pub dt: f64,
    /// Steps of the integrator for which an action is held.
    pub substeps: u32,
    /// What is seen, paid, and over.
    pub task: Task,
    /// Between which two ends position and velocity are at the start of an episode, in the units of the system.
    pub start: [[f64; 2]; 2],
    /// Actions after which an episode is cut off, if it is.
    pub limit: Option<u32>,
    /// What follows the end of an episode.
    pub autoreset: Autoreset,
    /// How late observations and actions are, in steps of the integrator.
    pub delays: Delays,
    /// The largest command; infinite for none.
    pub saturation: f64,
    /// What is not exact.
    pub noise: Noise,
}

/// Laws of what is random in every step, or in every episode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// Of the lengths of steps of the integrator, each by itself: of `ε` in `Δt·(1 + ε)`.
    pub jitter: Jitter,
    /// Of the rate of the clock in an episode: of `δ` in `Δt·(1 + δ)`.
    pub skew: Jitter,
    /// Of every number that is seen, in its unit.
    pub observation: Jitter,
}

impl Noise {
    /// None.
    pub const NONE: Noise = Noise {
        jitter: Jitter::Gaussian(0.0),
        skew: Jitter::Gaussian(0.0),
        observation: Jitter::Gaussian(0.0),
    };

    /// Whether there is none.
    pub fn is_none(&self) -> bool {
        [self.jitter, self.skew, self.observation].iter().all(|law| law.rms() == 0.0)
    }
}

impl Recipe {
    /// Units of positions, velocities and actions.
    pub fn units(&self) -> [&'static str; 3] {
        let Units { position, velocity, command, .. } =
            units::of(self.system.any(), self.actuation);
        // The position of a swing-up is an angle, whatever the system.
        match (&self.task, self.actuation) {
            (Task::SwingUp(_), Actuation::Acceleration) => ["rad", "rad/s", "rad/s²"],
            (Task::SwingUp(_), Actuation::Force { .. }) => ["rad", "rad/s", "N·m"],
            _ => [position, velocity, command],
        }
    }

    /// Names and units of what is seen.
    pub fn seen(&self) -> Vec<(&'static str, &'static str)> {
        let [position, velocity, _] = self.units();
        let unit = |seen| match seen {
            Seen::Position => position,
            Seen::Velocity => velocity,
            Seen::Neither => "1",
        };
        self.task.seen().iter().map(|&(name, seen)| (name, unit(seen))).collect()
    }
}
