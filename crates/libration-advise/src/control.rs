//! A control loop: its law, its timing, and what it costs.

use libration::analysis::ObserverNoise;
use libration::control::clock::{Recorded, RecordedError};
use libration::control::controller::PidGains;
use libration::control::{Feedback, Jitter, LqrWeights};

/// A loop and what is wrong with it.
#[derive(Clone, Debug, PartialEq)]
pub struct Control {
    /// Who commands.
    pub law: Law,
    /// Between two samples, in s.
    pub period: f64,
    /// How late a command arrives, in s.
    pub latency: f64,
    /// The law of sample times, with its relative rms.
    pub jitter: Jitter,
    /// The part by which the clock of the loop is slow; negative where it is fast.
    pub skew: f64,
    /// The probability that a command is lost.
    pub loss: f64,
    /// Steps that were measured, as multiples of their mean; they are replayed in place of `jitter`, whose rms is theirs.
    pub record: Option<Vec<f64>>,
    /// What the loop costs.
    pub weights: Option<LqrWeights>,
    /// How far from the operating point it must return from, in m or rad.
    pub deviation: f64,
}

/// A clock that is off by less does nothing to a loop.
const ON_TIME: f64 = 1e-6;

/// The relative rms of steps that only rounding tells apart.
const EVEN: f64 = 1e-9;

impl Control {
    /// This with a clock that was measured, whose time stamps are in seconds: where their mean is not the period, the clock is slow or
    /// fast by that.
    ///
    /// # Errors
    /// If they are no record of a clock.
    pub fn replaying(self, stamps: &[f64]) -> Result<Self, RecordedError> {
        let (steps, mean) = Recorded::steps_between(stamps)?;
        let square = steps.iter().map(|step| (step - 1.0).powi(2)).sum::<f64>();
        let rms = (square / steps.len() as f64).sqrt();
        let skew = mean / self.period - 1.0;
        let skew = if skew.abs() < ON_TIME { 0.0 } else { skew };
        // Steps that differ by their last digits alone are even.
        let (rms, record) = if rms < EVEN { (0.0, None) } else { (rms, Some(steps)) };
        Ok(Control { jitter: self.jitter.with_rms(rms), record, skew, ..self })
    }
}

/// Who commands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law {
    /// Feedback of position and velocity.
    Pd(Feedback),
    /// Three terms, of the position.
    Pid(PidGains<1>),
    /// The feedback that costs least, designed from the model.
    Lqr(LqrWeights),
    /// Feedback of a state that is estimated from the position.
    Observer {
        /// What is fed back.
        feedback: Regulator,
        /// How the estimate is corrected.
        correction: Correction,
    },
}

impl Law {
    /// The law of accelerations that does what this one does as a force on `mass`, in kg.
    pub(super) fn per_mass(self, mass: f64) -> Self {
        let regulator = |regulator| match regulator {
            Regulator::Gains(gains) => Regulator::Gains(gains.per_mass(mass)),
            Regulator::Lqr(weights) => Regulator::Lqr(weights.per_mass(mass)),
        };
        match self {
            Law::Pd(gains) => Law::Pd(gains.per_mass(mass)),
            Law::Pid(gains) => Law::Pid(PidGains {
                proportional: gains.proportional / mass,
                integral: gains.integral / mass,
                derivative: gains.derivative / mass,
                most: gains.most / mass,
                ..gains
            }),
            Law::Lqr(weights) => Law::Lqr(weights.per_mass(mass)),
            Law::Observer { feedback, correction } => {
                Law::Observer { feedback: regulator(feedback), correction }
            }
        }
    }
}

/// Gains, or what they are designed for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Regulator {
    /// These.
    Gains(Feedback),
    /// The feedback that costs least.
    Lqr(LqrWeights),
}

/// How an estimate is corrected by what is seen, or what that is designed for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Correction {
    /// By so much of what the position is off: the position, and the velocity in 1/s.
    Gains([f64; 2]),
    /// As varies least: a stationary Kalman filter.
    Kalman(ObserverNoise),
}
