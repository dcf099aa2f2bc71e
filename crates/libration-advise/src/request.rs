//! Requests for advice.

use libration::control::LqrWeights;
use libration_settings::equations::{EquationSystem, Twin};
use libration_settings::limits;

use super::AdviseError;
use super::control::Control;

/// A system, whatever describes it, with its controller, a tolerance and a horizon.
#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    /// The system with its start, at rest at the operating point for a loop.
    pub system: EquationSystem,
    /// The options of the command line that stand for the system and its start, such as `--system mine.toml`; none of a system of the
    /// catalogue, which its name, parameters and start stand for.
    pub options: Option<String>,
    /// The loop, if there is one.
    pub control: Option<Control>,
    /// The tolerance.
    pub tolerance: Tolerance,
    /// The horizon, in s.
    pub horizon: f64,
    /// The size of rollouts: environments, and steps of each.
    pub rollout: [usize; 2],
    /// Whether to compute a stability map.
    pub map: bool,
    /// The command line that repeats the request, without options of output.
    pub invocation: String,
}

/// A tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// The measure of the error.
    pub of: Measure,
    /// The largest allowed value.
    pub most: f64,
}

/// A measure of the error of a simulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// The largest error of the energy, relative to the mean kinetic energy of the motion.
    Energy,
    /// The final error of the phase, in rad.
    Phase,
    /// The largest distance from the true trajectory, relative to its size.
    Trajectory,
    /// The rise of the stationary cost of a loop, `ΔJ/J₀`.
    Cost,
}

impl Measure {
    /// All measures.
    pub const ALL: [Measure; 4] =
        [Measure::Energy, Measure::Phase, Measure::Trajectory, Measure::Cost];

    /// The name in files and flags.
    pub fn name(self) -> &'static str {
        match self {
            Measure::Energy => "energy",
            Measure::Phase => "phase",
            Measure::Trajectory => "trajectory",
            Measure::Cost => "cost",
        }
    }

    /// The description in one line.
    pub fn title(self) -> &'static str {
        match self {
            Measure::Energy => "largest error of the energy relative to the mean kinetic energy",
            Measure::Phase => "final error of the phase (rad)",
            Measure::Trajectory => "largest distance from the true trajectory relative to its size",
            Measure::Cost => "rise of the cost, ΔJ/J₀",
        }
    }
}

/// The fewest steps of `dt` seconds that cover `horizon`, of which rounding may take a part of a step.
pub(super) fn steps_over(horizon: f64, dt: f64) -> u64 {
    ((horizon / dt) * (1.0 - 1e-12)).ceil().max(1.0) as u64
}

impl Request {
    /// A request about a simulation of a system from its start.
    pub fn new(system: EquationSystem, tolerance: Tolerance, horizon: f64) -> Self {
        Request {
            system,
            options: None,
            control: None,
            tolerance,
            horizon,
            rollout: Request::ROLLOUT,
            map: false,
            invocation: String::new(),
        }
    }

    /// The size of rollouts where a request states none.
    pub const ROLLOUT: [usize; 2] = [4096, 1024];

    /// The command that takes the advised steps and, if possible, prints their error.
    pub(super) fn command(&self, integrator: &str, dt: f64, float: &str) -> String {
        match (&self.control, self.tolerance.of) {
            (None, Measure::Energy) => {
                format!("libration analyze {}", self.steps(integrator, dt))
            }
            _ => self.simulation(integrator, dt, float),
        }
    }

    /// The command that takes steps in a float type; for a loop the invocation.
    pub(super) fn simulation(&self, integrator: &str, dt: f64, float: &str) -> String {
        match &self.control {
            Some(_) => format!("{} --json", self.invocation),
            None => {
                let every = self.steps_of(dt);
                let steps = self.steps(integrator, dt);
                format!("libration simulate {steps} --save-every {every} --dtype {float}")
            }
        }
    }

    fn steps(&self, integrator: &str, dt: f64) -> String {
        let list = |x: &[f64]| x.iter().map(f64::to_string).collect::<Vec<_>>().join(",");
        let options = self.options.clone().unwrap_or_else(|| {
            let EquationSystem { q, v, .. } = &self.system;
            format!("{} --q {} --v {}", self.name_and_parameters(), list(q), list(v))
        });
        format!("{options} --integrator {integrator} --dt {dt} --steps {}", self.steps_of(dt))
    }

    /// The options of the command line for a system of the catalogue without its start.
    pub(super) fn name_and_parameters(&self) -> String {
        let parameters = self.system.definitions.parameters.iter();
        let set: String = parameters.map(|(name, x)| format!(" --set {name}={x}")).collect();
        format!("--system {}{set}", self.system.name)
    }

    /// The steps of `dt` seconds that cover the horizon.
    fn steps_of(&self, dt: f64) -> u64 {
        steps_over(self.horizon, dt)
    }

    /// Checks all numbers.
    ///
    /// # Errors
    /// [`AdviseError::Value`](super::AdviseError::Value): the first invalid number.
    pub fn check(&self) -> Result<(), AdviseError> {
        let ensure = |name, value: f64, allowed, holds: bool| match holds {
            true => Ok(()),
            false => Err(AdviseError::Value { name, value, allowed }),
        };
        let positive = |x: f64| x > 0.0 && x.is_finite();
        let above = "a finite number above 0";
        ensure("tolerance", self.tolerance.most, above, positive(self.tolerance.most))?;
        if let Some(Twin { system, actuation }) = self.system.twin {
            let parameters = actuation.parameters(system);
            if let Some((name, value)) = limits::find_out_of_range(parameters) {
                let system = self.system.name.clone();
                return Err(AdviseError::Parameter { system, name, value });
            }
        }
        let time = |x: f64| limits::SIZE.contains(&x);
        let seconds = "from 1e-60 to 1e60 s";
        ensure("request.horizon", self.horizon, seconds, time(self.horizon))?;
        for count in self.rollout {
            ensure(
                "request.rollout",
                count as f64,
                "from 1 to 1e9",
                (1..=1_000_000_000).contains(&count),
            )?;
        }
        for x in self.system.initial_state() {
            ensure("start.q", x, "a finite number", x.is_finite())?;
        }
        let Some(control) = &self.control else { return Ok(()) };
        let Control { period, latency, jitter, skew, loss, deviation, .. } = *control;
        ensure("loop.period", period, seconds, time(period))?;
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
        let wanted = "a mean interval of the time stamps of half to twice the period";
        ensure("loop.time_stamps", period * (1.0 + skew), wanted, near)?;
        ensure("loop.skew", skew, "above -1 and below 8", skew > -1.0 && skew < 8.0)?;
        ensure(
            "loop.loss",
            loss,
            "a probability of at least 0 and below 1",
            (0.0..1.0).contains(&loss),
        )?;
        ensure("loop.deviation", deviation, above, positive(deviation))?;
        for &v in &self.system.v {
            ensure("start.v", v, "0", v == 0.0)?;
        }
        Ok(())
    }
}
