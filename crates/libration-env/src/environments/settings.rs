//! Settings of environments.

use libration::Method;
use libration::catalog::Actuation;
use libration::control::Jitter;
use libration::rl::{Autoreset, Delays};
use libration_settings::units;
use libration_settings::units::Units;

use super::task::ObservedQuantity;
use super::{SingleDofSystem, Task};

/// The settings of an environment, except its float type.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnvironmentSettings {
    /// The system.
    pub system: SingleDofSystem,
    /// The quantity of actions.
    pub actuation: Actuation,
    /// The integrator.
    pub method: Method,
    /// The time step, in s.
    pub dt: f64,
    /// Steps of the integrator per action.
    pub substeps: u32,
    /// The task: observations, rewards and termination.
    pub task: Task,
    /// The ranges of initial position and velocity, in the units of the system.
    pub start: [[f64; 2]; 2],
    /// Actions after which an episode is truncated; none for no limit.
    pub limit: Option<u32>,
    /// The reset after the end of an episode.
    pub autoreset: Autoreset,
    /// Latencies of observations and actions, in steps of the integrator.
    pub delays: Delays,
    /// The largest command; infinite for none.
    pub saturation: f64,
    /// Noise of clocks and sensors.
    pub noise: Noise,
}

/// Noise of clocks and sensors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// The law of `ε` in `Δt·(1 + ε)`, drawn per step of the integrator.
    pub jitter: Jitter,
    /// The law of `δ` in `Δt·(1 + δ)`, drawn per episode.
    pub skew: Jitter,
    /// The law of the noise of each observation, in its unit.
    pub observation: Jitter,
}

impl EnvironmentSettings {
    /// Whether nothing is drawn, so that all environments under a fixed policy are the same.
    pub fn draws_nothing(&self) -> bool {
        let Noise { jitter, skew, observation } = self.noise;
        let Delays { observation: late, action } = self.delays;
        [jitter, skew, observation].iter().all(|law| law.rms() == 0.0)
            && self.start.iter().all(|[low, high]| low == high)
            && [late, action].iter().all(|[least, most]| least == most)
    }
}

impl Noise {
    /// No noise.
    pub const NONE: Noise = Noise {
        jitter: Jitter::Gaussian(0.0),
        skew: Jitter::Gaussian(0.0),
        observation: Jitter::Gaussian(0.0),
    };

    /// Whether there is no noise.
    pub fn is_none(&self) -> bool {
        [self.jitter, self.skew, self.observation].iter().all(|law| law.rms() == 0.0)
    }
}

impl EnvironmentSettings {
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

    /// Names and units of the observations.
    pub fn observed(&self) -> Vec<(&'static str, &'static str)> {
        let [position, velocity, _] = self.units();
        let unit = |seen| match seen {
            ObservedQuantity::Position => position,
            ObservedQuantity::Velocity => velocity,
            ObservedQuantity::Dimensionless => "1",
        };
        self.task.observed().iter().map(|&(name, seen)| (name, unit(seen))).collect()
    }
}
