//! Requests for trajectories.

use libration::catalog::Allowed;
use libration::equations::StepProgram;
use libration::{AnyMethod, AnySystem, Float};
use libration_settings::equations::{EquationSystem, Twin};
use libration_settings::limits;

use super::ensemble_options::rows;
use super::error::value_error;
use super::exact_step::exact;
use super::{EnsembleOptions, FloatType, TrajectoryError};
use crate::{Stepping, Timing};

/// Largest number of degrees of freedom of a loop: kernels for more take long to compile.
pub(super) const MOST_DIMENSIONS: usize = 2;

/// A system with its integrator, its initial state and the steps to keep.
#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    /// The system, with its start.
    pub system: EquationSystem,
    /// The integrator, or exact steps.
    pub stepping: Stepping,
    /// The float type of all numbers but the time.
    pub float: FloatType,
    /// The time step in seconds.
    pub dt: f64,
    /// Number of steps.
    pub steps: u64,
    /// The interval of kept steps. The start and the last step are always kept.
    pub every: u64,
    /// The ensemble; none for a single trajectory.
    pub ensemble: Option<EnsembleOptions>,
    /// Timing options of the control loop.
    pub timing: Timing,
    /// The steps of a recorded clock, in multiples of `dt`; none for even steps.
    pub record: Option<Vec<f64>>,
    /// The seed of all random numbers.
    pub seed: u64,
}

impl Request {
    /// Why steps of this integrator lose their order on this system; none if they do not.
    pub fn caveat(&self) -> Option<String> {
        self.system.caveat(self.stepping.method()?)
    }

    /// The first option that requires a loop.
    pub(super) fn loop_option(&self) -> Option<&'static str> {
        self.timing.first().or(self.record.as_ref().map(|_| "time-stamps"))
    }

    /// Ratio of the longest possible step to the time step.
    pub(super) fn longest(&self) -> f64 {
        let recorded = self.record.as_ref().map(|r| r.iter().copied().fold(0.0, f64::max));
        recorded.unwrap_or(1.0) * self.timing.longest()
    }

    /// Names and units of the columns, from left to right.
    pub fn columns(&self) -> Vec<(String, String)> {
        let trajectory = self.ensemble.iter().map(|_| ("trajectory".to_owned(), "1".to_owned()));
        trajectory.chain(time_columns(&self.system)).chain(value_columns(&self.system)).collect()
    }

    /// Number of rows if the state stays finite.
    pub fn rows(&self) -> u64 {
        rows(self.steps, self.every, self.ensemble.as_ref())
    }

    /// Checks every value, and that the float type `S` represents it.
    pub(super) fn check<S: Float>(&self) -> Result<(), TrajectoryError> {
        self.check_start::<S>()?;
        self.check_time_step::<S>()?;
        self.check_stepping()?;
        self.check_parameters::<S>()?;
        for (name, count) in [("steps", self.steps), ("every", self.every)] {
            if count == 0 {
                return Err(value_error(name, count, "at least 1"));
            }
        }
        if !limits::TRAJECTORY_STEPS.contains(&self.steps) {
            return Err(value_error("steps", self.steps, limits::trajectory_steps_allowed()));
        }
        if let Some(ensemble) = &self.ensemble {
            self.check_ensemble::<S>(ensemble)?;
        }
        if let Some(flag) = self.loop_option() {
            self.check_timing(flag)?;
        }
        if let Some(record) = self.record.as_ref().filter(|r| (r.len() as u64) < self.steps) {
            let allowed = format!("at most {}, the steps between the time stamps", record.len());
            return Err(value_error("steps", self.steps, allowed));
        }
        Ok(())
    }

    fn check_start<S: Float>(&self) -> Result<(), TrajectoryError> {
        for (name, values) in [("q", &self.system.q), ("v", &self.system.v)] {
            if !values.iter().all(|&x| S::from_f64(x).is_finite()) {
                let allowed = format!("finite in {}", S::NAME);
                return Err(value_error(name, list(values), allowed));
            }
        }
        Ok(())
    }

    fn check_ensemble<S: Float>(&self, ensemble: &EnsembleOptions) -> Result<(), TrajectoryError> {
        ensemble.check()?;
        let furthest = 1.0 + ensemble.spread.abs();
        let all = self.system.q.iter().chain(&self.system.v);
        if !all.into_iter().all(|&x| S::from_f64(furthest * x).is_finite()) {
            let allowed = format!("small enough for finite starts in {}", S::NAME);
            return Err(value_error("spread", format!("{:?}", ensemble.spread), allowed));
        }
        Ok(())
    }

    fn check_timing(&self, flag: &'static str) -> Result<(), TrajectoryError> {
        let (system, dimension) = (&self.system.name, self.system.q.len());
        let Some(twin) = self.system.twin else {
            let value = format!("given for {system}");
            return Err(value_error(flag, value, "for a system of the catalogue"));
        };
        if dimension > MOST_DIMENSIONS {
            let value = format!("given for {system} in {dimension} dimensions");
            return Err(value_error(flag, value, format!("for at most {}", MOST_DIMENSIONS)));
        }
        // A command would change the time.
        if self.timing.feedback.is_some() && matches!(twin.system, AnySystem::DrivenOscillator(_)) {
            let value = format!("given for {system}");
            return Err(value_error("feedback", value, "for a system without a time coordinate"));
        }
        let latency = self.timing.latency_of(self.dt);
        let excessive = || self.timing.excessive_latency(self.dt);
        latency.map(|_| ()).map_err(|steps| {
            excessive().map_or_else(
                || TrajectoryError::latency(steps, self.dt),
                TrajectoryError::ExcessiveLatency,
            )
        })
    }

    fn check_time_step<S: Float>(&self) -> Result<(), TrajectoryError> {
        let dt = format!("{:?}", self.dt);
        if !Allowed::Positive.admits(self.dt) {
            return Err(value_error("dt", dt, Allowed::Positive));
        }
        let rounded = S::from_f64(self.dt).to_f64();
        if !Allowed::Positive.admits(rounded) {
            let allowed = format!("{} in {}, where it is {rounded}", Allowed::Positive, S::NAME);
            return Err(value_error("dt", dt, allowed));
        }
        Ok(())
    }

    fn check_stepping(&self) -> Result<(), TrajectoryError> {
        if let (Stepping::Implicit(method), Some(flag)) = (self.stepping, self.loop_option()) {
            let value = format!("{} with --{flag}", method.name());
            return Err(value_error(
                "integrator",
                value,
                "an explicit integrator, such as `rk4`, in a loop",
            ));
        }
        if let Some(method) = self.stepping.any_method() {
            return self.check_size(method);
        }
        if self.ensemble.is_some() && self.system.twin.is_none() {
            let value = format!("{} for several trajectories", self.stepping.name());
            return Err(value_error("integrator", value, "for a system of the catalogue"));
        }
        exact(&self.system, self.dt, self.longest()).map(|_| ())
    }

    fn check_size(&self, method: AnyMethod) -> Result<(), TrajectoryError> {
        let degrees = self.system.equations.degrees().len();
        let most = StepProgram::most_degrees(method);
        if degrees > most {
            let given = format!("{} for {degrees} degrees of freedom", method.name());
            let allowed = format!("an explicit integrator for more than {most}");
            return Err(value_error("integrator", given, allowed));
        }
        Ok(())
    }

    fn check_parameters<S: Float>(&self) -> Result<(), TrajectoryError> {
        for (name, value) in self.parameters() {
            let rounded = S::from_f64(value).to_f64();
            if !rounded.is_finite() || (rounded == 0.0) != (value == 0.0) {
                let system = self.system.name.clone();
                let float = S::NAME;
                return Err(TrajectoryError::Parameter { system, name, value, rounded, float });
            }
        }
        Ok(())
    }

    /// The parameters that the float type must represent: those of the compiled system, where a frequency stands for a mass and a stiffness.
    fn parameters(&self) -> Vec<(String, f64)> {
        match self.system.twin {
            Some(Twin { system, .. }) => {
                system.parameters().into_iter().map(|(name, x)| (name.to_owned(), x)).collect()
            }
            None => self.system.definitions.parameters.clone(),
        }
    }
}

/// Names and units of the columns of the step and of the time.
pub(crate) fn time_columns(system: &EquationSystem) -> Vec<(String, String)> {
    vec![("step".to_owned(), "1".to_owned()), ("t".to_owned(), system.time_unit.clone())]
}

/// Names and units of the columns of the states, and of the energy where the system has one.
pub(crate) fn value_columns(system: &EquationSystem) -> Vec<(String, String)> {
    let states = system.states.iter().map(|state| (state.name.clone(), state.unit.clone()));
    let energy = system.equations.dynamics().energy();
    states.chain(energy.map(|_| ("energy".to_owned(), system.energy_unit.clone()))).collect()
}

fn list(values: &[f64]) -> String {
    values.iter().map(f64::to_string).collect::<Vec<_>>().join(",")
}
