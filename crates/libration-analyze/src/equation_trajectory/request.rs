//! Requests for trajectories of systems by equations.

use libration::AnyMethod;
use libration::catalog::Allowed;
use libration::equations::StepProgram;
use libration_settings::equations::EquationSystem;
use libration_settings::limits;

use crate::trajectory::{EnsembleFloat, EnsembleOptions, FloatType, TrajectoryError, rows};

/// A system by equations with its integrator and the steps to keep.
#[derive(Clone, Debug, PartialEq)]
pub struct EquationRequest {
    /// The system, with its start.
    pub system: EquationSystem,
    /// The integrator.
    pub method: AnyMethod,
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
}

impl EquationRequest {
    /// Why steps of this integrator lose their order on this system; none if they do not.
    pub fn caveat(&self) -> Option<String> {
        let AnyMethod::Explicit(method) = self.method else { return None };
        let is_positional = self.system.equations.dynamics().is_positional();
        (method.supposes_positional_forces() && !is_positional).then(|| {
            format!(
                "a force of `{}` depends on a velocity, which `{}` does not suppose: its errors are those of order 1; `rk4` keeps its order",
                self.system.name,
                method.name()
            )
        })
    }

    /// Names and units of the columns, from left to right.
    pub fn columns(&self) -> Vec<(String, String)> {
        let named = |name: &str, unit: &str| (name.to_owned(), unit.to_owned());
        let mut names: Vec<_> = self.ensemble.iter().map(|_| named("trajectory", "1")).collect();
        names.extend([named("step", "1"), named("t", "s")]);
        names.extend(self.system.states.iter().map(|state| named(&state.name, &state.unit)));
        let energy = self.system.equations.dynamics().energy();
        names.extend(energy.map(|_| named("energy", &self.system.energy_unit)));
        names
    }

    /// Number of rows if the state stays finite.
    pub fn rows(&self) -> u64 {
        rows(self.steps, self.every, self.ensemble.as_ref())
    }

    /// Checks every value, and that the float type `S` represents it.
    pub(super) fn check<S: EnsembleFloat>(&self) -> Result<(), TrajectoryError> {
        let value = |name, value: String, allowed: String| {
            Err(TrajectoryError::Value { name, value, allowed })
        };
        if !Allowed::Positive.admits(S::from_f64(self.dt).to_f64()) {
            let allowed = format!("{} in {}", Allowed::Positive, S::NAME);
            return value("dt", format!("{:?}", self.dt), allowed);
        }
        if !limits::TRAJECTORY_STEPS.contains(&self.steps) {
            return value("steps", self.steps.to_string(), limits::trajectory_steps_allowed());
        }
        let degrees = self.system.equations.degrees().len();
        let most = StepProgram::most_degrees(self.method);
        if degrees > most {
            let given = format!("{} for {degrees} degrees of freedom", self.method.name());
            return value(
                "integrator",
                given,
                format!("an explicit integrator for more than {most}"),
            );
        }
        if self.every == 0 {
            return value("every", "0".to_owned(), "at least 1".to_owned());
        }
        for (name, numbers) in [("q", &self.system.q), ("v", &self.system.v)] {
            if let Some(x) = numbers.iter().find(|x| !S::from_f64(**x).is_finite()) {
                return value(name, format!("{x:?}"), format!("finite in {}", S::NAME));
            }
        }
        if let Some(ensemble) = &self.ensemble {
            ensemble.check()?;
            S::check_ensemble(self.system.equations.degrees().len(), ensemble)?;
        }
        Ok(())
    }
}
