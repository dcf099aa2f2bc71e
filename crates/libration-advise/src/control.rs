//! Control loops: law, timing and cost.

use libration::analysis::ObserverNoise;
use libration::control::clock::{Recorded, RecordedError};
use libration::control::controller::PidGains;
use libration::control::{Feedback, Jitter, LqrWeights};

/// A control loop with its timing imperfections.
#[derive(Clone, Debug, PartialEq)]
pub struct Control {
    /// The control law.
    pub law: Law,
    /// The sampling period, in s.
    pub period: f64,
    /// The latency of the command, in s.
    pub latency: f64,
    /// The law of sample times, with its relative rms.
    pub jitter: Jitter,
    /// The relative error of the period: positive for a slow clock, negative for a fast one.
    pub skew: f64,
    /// The probability that a command is lost.
    pub loss: f64,
    /// Recorded steps, as multiples of their mean. They replace the law of `jitter`, which has their rms.
    pub record: Option<Vec<f64>>,
    /// The weights of the cost; none for those of the energy.
    pub weights: Option<LqrWeights>,
    /// The distance from the operating point from which the loop must return, in m or rad.
    pub deviation: f64,
}

/// Skew below which a clock counts as exact.
const ON_TIME: f64 = 1e-6;

/// Relative rms below which steps differ by rounding only.
const EVEN: f64 = 1e-9;

impl Control {
    /// The same loop with a recorded clock. `stamps` are its time stamps in s; their mean interval determines the skew.
    ///
    /// # Errors
    /// If the time stamps are invalid.
    pub fn with_time_stamps(self, stamps: &[f64]) -> Result<Self, RecordedError> {
        let (steps, mean) = Recorded::steps_between(stamps)?;
        let skew = skew_of(mean, self.period);
        let (rms, record) = uneven(steps);
        Ok(Control { jitter: self.jitter.with_rms(rms), record, skew, ..self })
    }
}

/// The skew of a clock with this mean interval, in s.
pub(super) fn skew_of(mean: f64, period: f64) -> f64 {
    let skew = mean / period - 1.0;
    if skew.abs() < ON_TIME { 0.0 } else { skew }
}

/// The rms of relative steps, and the steps themselves if they differ by more than rounding.
pub(super) fn uneven(steps: Vec<f64>) -> (f64, Option<Vec<f64>>) {
    let square = steps.iter().map(|step| (step - 1.0).powi(2)).sum::<f64>();
    let rms = (square / steps.len() as f64).sqrt();
    if rms < EVEN { (0.0, None) } else { (rms, Some(steps)) }
}

/// A control law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law {
    /// Feedback of position and velocity.
    Pd(Feedback),
    /// Three terms of the position.
    Pid(PidGains<1>),
    /// The feedback of least cost, designed from the model.
    Lqr(LqrWeights),
    /// Feedback of a state estimated from the position.
    Observer {
        /// The feedback of the estimate.
        feedback: Regulator,
        /// The correction of the estimate.
        correction: Correction,
    },
}

impl Law {
    /// The law of accelerations equivalent to this law of forces on `mass`, in kg.
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

/// Gains, or the weights of their design.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Regulator {
    /// Given gains.
    Gains(Feedback),
    /// The feedback of least cost.
    Lqr(LqrWeights),
}

/// The correction of an estimate by the observed position, or the noise of its design.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Correction {
    /// Gains of the position and, in 1/s, of the velocity.
    Gains([f64; 2]),
    /// The stationary Kalman filter.
    Kalman(ObserverNoise),
}
