//! What is asked.

use libration::AnySystem;
use libration::analysis::{Feedback, Jitter, LqrWeights, ObserverNoise};
use libration::control::clock::{Recorded, RecordedError};
use libration::control::controller::PidGains;

use super::AdviseError;

/// A plant, who controls it, what it may lose and what its surroundings are.
#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    /// The system.
    pub system: AnySystem,
    /// Positions at the start; of a loop those of the operating point.
    pub q: Vec<f64>,
    /// Velocities at the start.
    pub v: Vec<f64>,
    /// The loop, if there is one.
    pub control: Option<Control>,
    /// What is tolerated.
    pub tolerance: Tolerance,
    /// For how long, in s.
    pub horizon: f64,
    /// What is to be rolled out: environments, and steps of each.
    pub rollout: [usize; 2],
    /// Whether a map of stability is wanted.
    pub map: bool,
    /// The command that asks this again, without where it writes and how.
    pub asked_by: String,
}

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

/// What may be lost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Of what.
    pub of: Measure,
    /// How much of it.
    pub most: f64,
}

/// What is measured of a simulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// The largest relative error of the energy.
    Energy,
    /// The error of the phase in the end, in rad.
    Phase,
    /// The largest distance from the true trajectory, over its size.
    Trajectory,
    /// The rise of the stationary cost of a loop, `ΔJ/J₀`.
    Cost,
}

impl Measure {
    /// All of them.
    pub const ALL: [Measure; 4] =
        [Measure::Energy, Measure::Phase, Measure::Trajectory, Measure::Cost];

    /// Its name in files and flags.
    pub fn name(self) -> &'static str {
        match self {
            Measure::Energy => "energy",
            Measure::Phase => "phase",
            Measure::Trajectory => "trajectory",
            Measure::Cost => "cost",
        }
    }

    /// What it is.
    pub fn title(self) -> &'static str {
        match self {
            Measure::Energy => "largest relative error of the energy",
            Measure::Phase => "error of the phase in the end (rad)",
            Measure::Trajectory => "largest distance from the true trajectory, over its size",
            Measure::Cost => "rise of the cost, ΔJ/J₀",
        }
    }
}

impl Request {
    /// The parameters of the system, as flags.
    pub(super) fn parameters(&self) -> String {
        let each = self.system.parameters().into_iter();
        each.map(|(name, value)| format!(" --set {name}={value}")).collect()
    }

    /// The command that takes the steps that are advised, and says what they lose where that can be said.
    pub(super) fn command(&self, integrator: &str, dt: f64, float: &str) -> String {
        match (&self.control, self.tolerance.of) {
            (None, Measure::Energy) => {
                format!("libration analyze {}", self.steps(integrator, dt))
            }
            _ => self.simulation(integrator, dt, float),
        }
    }

    /// The command that takes steps in a float type; of a loop the one that asks again.
    pub(super) fn simulation(&self, integrator: &str, dt: f64, float: &str) -> String {
        match &self.control {
            Some(_) => format!("{} --json", self.asked_by),
            None => {
                let every = (self.horizon / dt).round().max(1.0);
                let steps = self.steps(integrator, dt);
                format!("libration simulate {steps} --every {every} --float {float}")
            }
        }
    }

    fn steps(&self, integrator: &str, dt: f64) -> String {
        let list = |x: &[f64]| x.iter().map(f64::to_string).collect::<Vec<_>>().join(",");
        format!(
            "--system {}{} --q {} --v {} --integrator {integrator} --dt {dt} --steps {}",
            self.system.name(),
            self.parameters(),
            list(&self.q),
            list(&self.v),
            (self.horizon / dt).round().max(1.0)
        )
    }

    /// Checks all numbers.
    ///
    /// # Errors
    /// [`AdviseError::Value`](super::AdviseError::Value): the first that cannot be.
    pub fn check(&self) -> Result<(), AdviseError> {
        let ensure = |name, value: f64, allowed, holds: bool| match holds {
            true => Ok(()),
            false => Err(AdviseError::Value { name, value, allowed }),
        };
        let positive = |x: f64| x > 0.0 && x.is_finite();
        let above = "a finite number above 0";
        ensure("tolerance", self.tolerance.most, above, positive(self.tolerance.most))?;
        ensure("asked.horizon", self.horizon, above, positive(self.horizon))?;
        for count in self.rollout {
            ensure(
                "asked.rollout",
                count as f64,
                "from 1 to 1e9",
                (1..=1_000_000_000).contains(&count),
            )?;
        }
        for &x in self.q.iter().chain(&self.v) {
            ensure("start.q", x, "a finite number", x.is_finite())?;
        }
        let Some(control) = &self.control else { return Ok(()) };
        let Control { period, latency, jitter, skew, loss, deviation, .. } = *control;
        ensure("loop.period", period, above, positive(period))?;
        ensure(
            "loop.latency",
            latency,
            "a finite number of at least 0",
            (0.0..f64::INFINITY).contains(&latency),
        )?;
        if let Some(LqrWeights { position, velocity, command }) = control.weights {
            let all = [position, velocity, command];
            for weight in all {
                ensure(
                    "loop.cost",
                    weight,
                    "finite and at least 0",
                    weight >= 0.0 && weight.is_finite(),
                )?;
            }
            let none = all.iter().all(|weight| *weight == 0.0);
            ensure("loop.cost", 0.0, "above 0 for one of the three", !none)?;
        }
        ensure(
            "loop.jitter",
            jitter.rms(),
            "a relative rms from 0 to 1",
            control.record.is_some() || (0.0..=1.0).contains(&jitter.rms()),
        )?;
        let near = control.record.is_none() || (-0.5..=1.0).contains(&skew);
        let wanted = "time stamps a period apart, or at most twice and at least half of that";
        ensure("loop.time_stamps", period * (1.0 + skew), wanted, near)?;
        ensure("loop.skew", skew, "above -1 and below 8", skew > -1.0 && skew < 8.0)?;
        ensure(
            "loop.loss",
            loss,
            "a probability of at least 0 and below 1",
            (0.0..1.0).contains(&loss),
        )?;
        ensure("loop.deviation", deviation, above, positive(deviation))?;
        for &v in &self.v {
            ensure("start.v", v, "0", v == 0.0)?;
        }
        Ok(())
    }
}
