//! Trajectories with adaptive steps as tables.
//!
//! The columns are `step`, `t`, the length of the step that led there (`dt`), the states, and the energy where the system has one.

use std::io::Write;

use libration::Method;
use libration_settings::equations::EquationSystem;
use libration_settings::limits;
use serde_json::{Value, json};

use super::{AdaptiveFailure, AdaptivePrograms, AdaptiveStepper, StepControl};
use crate::export::Rows;
use crate::recording::{self, Recording};
use crate::trajectory::{
    Divergence, Format, Monitor, Outcome, Trajectory, TrajectoryError, rows as rows_of,
    time_columns, value_columns,
};

/// Version of the JSON format.
const SCHEMA: &str = "libration.adaptive-trajectory/1";

/// Steps between two checks of the monitor.
const CHUNK: u64 = 1 << 12;

/// A motion with adaptive steps.
#[derive(Clone, Debug, PartialEq)]
pub struct AdaptiveRequest {
    /// The system with its start; its inputs are zero.
    pub system: EquationSystem,
    /// The integrator.
    pub method: Method,
    /// How the length of a step is chosen.
    pub control: StepControl,
    /// The length of the first step in s.
    pub dt: f64,
    /// Number of steps.
    pub steps: u64,
    /// The interval of kept steps. The start and the last step are always kept.
    pub every: u64,
}

/// Simulates the request, until the end or until `monitor` stops it, and keeps all rows.
///
/// # Errors
/// A [`TrajectoryError`], before any work if the request is invalid.
pub fn simulate_until(
    request: &AdaptiveRequest,
    monitor: &dyn Monitor,
) -> Result<Trajectory, TrajectoryError> {
    request.check()?;
    let (table, outcome) = recording::table::<f64>(request, monitor, |_, _| 0)?;
    Ok(Trajectory { table, outcome })
}

/// Simulates the request and writes its rows into `out`, until the end or until `monitor` stops it.
///
/// # Errors
/// A [`TrajectoryError`], before any work if the request is invalid.
pub fn write(
    request: &AdaptiveRequest,
    format: Format,
    out: &mut (dyn Write + Send),
    monitor: &dyn Monitor,
) -> Result<Outcome, TrajectoryError> {
    request.check()?;
    recording::write::<f64>(request, format, out, monitor)
}

impl AdaptiveRequest {
    fn check(&self) -> Result<(), TrajectoryError> {
        let wrong = |name, value: String, allowed: &str| {
            Err(TrajectoryError::Value { name, value, allowed: allowed.to_owned() })
        };
        if !(self.dt > 0.0 && self.dt.is_finite()) {
            return wrong("dt", format!("{:?}", self.dt), "positive and finite");
        }
        if !limits::TRAJECTORY_STEPS.contains(&self.steps) {
            let allowed = limits::trajectory_steps_allowed();
            return wrong("steps", self.steps.to_string(), &allowed);
        }
        if self.every == 0 {
            return wrong("every", "0".to_owned(), "at least 1");
        }
        let start = self.system.initial_state();
        if let Some(x) = start.iter().find(|x| !x.is_finite()) {
            return wrong("start", format!("{x:?}"), "finite");
        }
        match AdaptiveStepper::new(&self.programs(), self.control, &start, self.dt) {
            Some(_) => Ok(()),
            None => wrong(
                "adaptive",
                format!("{} for {}", self.control.name(), self.system.name),
                "forces that change in space at the start: their derivatives set the length of a step",
            ),
        }
    }

    fn programs(&self) -> AdaptivePrograms {
        AdaptivePrograms::new(self.system.equations.dynamics(), self.method)
    }

    /// Why a step back does not undo a step, if it does not.
    pub fn irreversibility(&self) -> Option<String> {
        let method = self.method.name();
        if self.control == StepControl::Naive {
            None
        } else if !self.system.equations.dynamics().is_positional() {
            Some("a force depends on a velocity".to_owned())
        } else if !self.programs().is_symmetric() {
            Some(format!("{method} is not symmetric"))
        } else {
            None
        }
    }

    fn outcome(&self, failure: AdaptiveFailure, step: u64, t: f64) -> Outcome {
        let reason = match failure {
            AdaptiveFailure::NotFinite => "the state stopped being finite",
            AdaptiveFailure::Density => {
                "the density of steps lost the frequency of the forces; help: a shorter first step (--dt), or fixed steps where the frequency passes near zero"
            }
            AdaptiveFailure::NoSolution => {
                "the length of the step has no solution; help: a shorter first step (--dt), or fixed steps where the frequency passes near zero"
            }
            AdaptiveFailure::NoTime => "steps are so short that time stands still: a collision",
            AdaptiveFailure::OffGrid => "the state is too large for the grid",
        };
        Outcome::Diverged(Divergence { step, t, reason: reason.to_owned(), newton_residual: None })
    }
}

impl Recording<f64> for AdaptiveRequest {
    fn columns(&self) -> Vec<(String, String)> {
        let mut names = time_columns(&self.system);
        names.push(("dt".to_owned(), self.system.time_unit.clone()));
        names.extend(value_columns(&self.system));
        names
    }

    fn is_ensemble(&self) -> bool {
        false
    }

    fn rows(&self) -> u64 {
        rows_of(self.steps, self.every, None)
    }

    fn head(&self) -> Vec<(&'static str, Value)> {
        let (names, units): (Vec<String>, Vec<String>) = self.columns().into_iter().unzip();
        vec![
            ("schema", SCHEMA.into()),
            ("system", self.system.name.clone().into()),
            ("integrator", self.method.name().into()),
            ("adaptive", self.control.name().into()),
            ("dt", self.dt.into()),
            ("steps", self.steps.into()),
            ("every", self.every.into()),
            ("columns", json!(names)),
            ("units", json!(units)),
        ]
    }

    fn run(
        &self,
        rows: &mut dyn Rows<f64>,
        monitor: &dyn Monitor,
    ) -> Result<Outcome, TrajectoryError> {
        let EquationSystem { equations, states, .. } = &self.system;
        let programs = self.programs();
        let start = self.system.initial_state();
        let stepper = AdaptiveStepper::new(&programs, self.control, &start, self.dt);
        // A checked request has a stepper.
        let Some(mut stepper) = stepper else { return Ok(Outcome::Complete) };
        let mut energy_of = equations.dynamics().energy().map(|energy| energy.on::<f64>());
        let mut inputs = self.system.start();
        let mut values = Vec::new();
        for step in 0..=self.steps {
            if step % self.every == 0 || step == self.steps {
                values.clear();
                values.push(stepper.last_length());
                values.extend(states.iter().map(|state| stepper.state()[state.place]));
                inputs[..start.len()].copy_from_slice(stepper.state());
                values.extend(energy_of.iter_mut().flat_map(|energy| energy.run(&inputs)));
                rows.row(&[step], stepper.time(), &values)?;
            }
            if step % CHUNK == 0 {
                if monitor.should_stop() {
                    return Err(TrajectoryError::Interrupted);
                }
                monitor.on_step(step);
            }
            if step < self.steps
                && let Err(failure) = stepper.advance()
            {
                return Ok(self.outcome(failure, step + 1, stepper.time()));
            }
        }
        Ok(Outcome::Complete)
    }
}
