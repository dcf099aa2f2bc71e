//! Analysis of systems by equations: the output of `libration list FILE` and `libration analyze --system FILE`.

mod motion;
mod motion_steps;
mod step;
mod summary;
mod verdicts;

use std::sync::atomic::AtomicBool;

use libration::equations::StepProgram;
use libration::simulation::SimulationError;
use libration::{AnyMethod, Float};
use libration_settings::equations::EquationSystem;
use libration_settings::linear_loop::{OperatingPoint, linearised_equations};
use serde::Serialize;

use crate::AnalyzeError;
use crate::linear_analysis::{self, LinearAnalysis, LinearAnalysisError, LinearRequest};
use crate::step::{StepMatrix, Stepping};

pub use crate::motion::{EnergyChange, MotionExamination, StateExamination};
use crate::newton_residual::{self, NewtonResidual};
pub use motion::{EquationMotion, StateError};
pub use motion_steps::MotionSteps;
pub use step::{spectral_radius, step_order};
pub use summary::{EquationSummary, SummaryParameter, SummaryState, SummaryTask};
pub use verdicts::EquationVerdicts;

/// Version of the JSON format.
pub const SCHEMA: &str = "libration.equation-analysis/1";

/// The analysis of a system by equations; the fields are the keys of `analyze --system FILE --json`.
#[derive(Clone, Debug, Serialize)]
pub struct EquationAnalysis {
    /// The version of this format.
    pub schema: &'static str,
    /// The system.
    pub system: EquationSummary,
    /// The motion from its start.
    pub motion: EquationMotion,
    /// A step from the start as a matrix; none of systems with states of first order, or of more than eight degrees of freedom, and where the
    /// step has no derivative.
    #[serde(flatten)]
    pub matrix: Option<StepMatrix>,
    /// What the Newton steps of an implicit integrator leave in the motion; none without an iteration.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub newton_residual: Option<NewtonResidual>,
    /// The equilibrium near its start; none if none was found.
    pub operating_point: Option<OperatingPoint>,
    /// The system about the equilibrium.
    pub linear: Option<LinearAnalysis>,
    /// The stable steps along the motion.
    pub steps_along_motion: MotionSteps,
    /// The reason why there are no modes, if there are none.
    pub no_modes: Option<String>,
    /// The verdicts on the step and on the motion.
    pub verdicts: EquationVerdicts,
}

/// Analyses steps of `dt` seconds of a system from its start and about an equilibrium, until `stop` is set. Errors and the drift of the
/// energy are those of `steps` steps, or of fewer where they take long.
///
/// # Errors
/// [`AnalyzeError::Simulation`] for an invalid time step, [`AnalyzeError::ImplicitDegrees`], and [`AnalyzeError::Interrupted`].
pub fn analyze(
    system: &EquationSystem,
    method: impl Into<AnyMethod>,
    dt: f64,
    steps: u64,
    stop: &AtomicBool,
) -> Result<EquationAnalysis, AnalyzeError> {
    if !(dt.is_finite() && dt > 0.0) {
        return Err(SimulationError::TimeStep { dt, float: f64::NAME }.into());
    }
    let (method, degrees) = (method.into(), system.equations.degrees().len());
    let most = StepProgram::most_degrees(method);
    if degrees > most {
        return Err(AnalyzeError::ImplicitDegrees { integrator: method.name(), most, degrees });
    }
    let (operating_point, linear, no_modes) = match linearised_equations(system) {
        Ok((plant, point)) => {
            let integrator = Some(Stepping::from(method));
            let open_loop = LinearRequest::open_loop(plant, dt, integrator);
            let open_loop =
                open_loop.map(|own| LinearRequest { operating_point: Some(point.clone()), ..own });
            let analysis = open_loop.and_then(|request| {
                linear_analysis::analyze(&request, stop).or_else(|error| match error {
                    // With states of first order the theory of an integrator applies only if it treats all states alike.
                    LinearAnalysisError::Integrator { .. } => {
                        let all = LinearRequest { integrator: None, ..request };
                        linear_analysis::analyze(&all, stop)
                    }
                    error => Err(error),
                })
            });
            match analysis {
                Ok(linear) => {
                    (Some(point), Some(LinearAnalysis { operating_point: None, ..linear }), None)
                }
                Err(LinearAnalysisError::Interrupted) => return Err(AnalyzeError::Interrupted),
                Err(error) => (Some(point), None, Some(error.to_string())),
            }
        }
        Err(fault) => (None, None, Some(fault.message)),
    };
    let equilibrium = operating_point.as_ref().map(|point| point.state_of(system));
    let motion = EquationMotion::new(system, method, dt, steps, equilibrium.as_deref(), stop)?;
    let horizon = motion.error_steps as f64 * dt;
    let steps_along_motion = MotionSteps::new(system, method, horizon, stop)?;
    let verdicts = EquationVerdicts::new(
        system,
        method,
        &motion,
        equilibrium.as_deref(),
        linear.as_ref(),
        &steps_along_motion,
    );
    let places = system.states.iter().map(|state| state.place).collect();
    let dynamics = system.equations.dynamics();
    let newton_residual =
        newton_residual::of_run(method, dynamics, &system.start(), places, (dt, steps), stop);
    Ok(EquationAnalysis {
        schema: SCHEMA,
        system: EquationSummary::new(system),
        motion,
        matrix: StepMatrix::at_start(system, &StepProgram::of(method, dynamics), dt),
        newton_residual,
        operating_point,
        linear,
        steps_along_motion,
        no_modes,
        verdicts,
    })
}
