//! Timing options of a control loop.

use libration::control::{Feedback, Jitter, Latency, LqrWeights};
use libration_settings::duration;

/// Timing options of a control loop.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Timing {
    /// The feedback that closes the loop.
    pub feedback: Option<Feedback>,
    /// The latency of the command; none for zero.
    pub latency: Option<LatencyOption>,
    /// The law of step times.
    pub jitter: Option<Jitter>,
    /// The law of clock rates over an ensemble.
    pub skew: Option<Jitter>,
    /// The probability that a command is lost.
    pub loss: Option<f64>,
    /// The weights of the cost; none for those of the energy.
    pub weights: Option<LqrWeights>,
}

/// A latency option, in seconds or in steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LatencyOption {
    /// In seconds.
    Seconds(f64),
    /// In steps.
    Steps(f64),
}

impl Timing {
    /// The name of the first option that is set.
    pub(crate) fn first(&self) -> Option<&'static str> {
        let given = [
            (self.feedback.is_some(), "feedback"),
            (self.latency.is_some(), "latency"),
            (self.jitter.is_some(), "jitter"),
            (self.skew.is_some(), "skew"),
            (self.loss.is_some(), "loss"),
            (self.weights.is_some(), "cost-weights"),
        ];
        given.into_iter().find_map(|(given, name)| given.then_some(name))
    }

    /// The same options for commands as accelerations in place of forces on `mass`.
    pub(super) fn per_mass(self, mass: f64) -> Self {
        Timing {
            feedback: self.feedback.map(|gains| gains.per_mass(mass)),
            weights: self.weights.map(|weights| weights.per_mass(mass)),
            ..self
        }
    }

    /// Whether steps or losses are random.
    pub fn draws(&self) -> bool {
        self.jitter.is_some() || self.loss.is_some()
    }

    /// Ratio of the longest possible step to the time step.
    pub(crate) fn longest(&self) -> f64 {
        [self.jitter, self.skew].into_iter().flatten().map(|law| 1.0 + law.largest()).product()
    }

    /// The error of a latency in seconds that is far too long for steps of `dt` seconds; none for one in steps.
    pub(crate) fn excessive_latency(&self, dt: f64) -> Option<String> {
        match self.latency {
            Some(LatencyOption::Seconds(seconds)) if seconds > Latency::MOST_STEPS as f64 * dt => {
                Some(duration::excessive_latency(seconds, dt))
            }
            _ => None,
        }
    }

    /// The latency in steps of `dt` seconds.
    ///
    /// # Errors
    /// The number of steps, if it is negative, not finite or too large.
    pub(crate) fn latency_of(&self, dt: f64) -> Result<Latency, f64> {
        match self.latency {
            None => Ok(Latency::NONE),
            Some(LatencyOption::Steps(steps)) => Latency::of_steps(steps).ok_or(steps),
            Some(LatencyOption::Seconds(s)) => Latency::of_seconds(s, dt).ok_or(s / dt),
        }
    }
}
