//! The result of an analysis.

use libration_settings::linear_loop::OperatingPoint;
use serde::Serialize;

use super::{AboutEquilibrium, MotionSteps, StepVerdicts, SteppedMotion};
use crate::linear_analysis::LinearAnalysis;
use crate::newton_residual::NewtonResidual;
use crate::step::{Drift, LargestDt, LoopAnalysis, ModifiedHamiltonian, OrderOfWord, StepMatrix};
use crate::system_summary::SystemSummary;

/// Version of the JSON format.
pub(super) const SCHEMA: &str = "libration.analysis/1";

/// The analysis of steps of an integrator on a system, and of a loop around it; the fields are the keys of `analyze --json`.
#[derive(Debug, Serialize)]
pub struct Analysis {
    /// The version of this format.
    pub schema: &'static str,
    /// The system.
    pub system: SystemSummary,
    /// The integrator.
    pub integrator: &'static str,
    /// The time step, in s.
    pub dt: f64,
    /// Number of steps of the motion and of the drift of the energy.
    pub steps: u64,
    /// A caveat about the integrator on this system, if there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
    /// A step from the start as a matrix; none of systems with states of first order, of more than eight degrees of freedom, and where the
    /// step has no derivative.
    #[serde(flatten)]
    pub matrix: Option<StepMatrix>,
    /// The update matrix of the oscillator with ω = 1 as exact polynomials in `z = ωΔt`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub update_matrix_in_z: Option<Vec<Vec<String>>>,
    /// Whether every orbit stays bounded; unknown for nonlinear systems and for marginal coupled modes.
    pub bounded: Option<bool>,
    /// The intervals `[from, to]` of Δt in s within which every orbit of uncoupled oscillators that are alike stays bounded, isolated
    /// exactly; of a free mass, whose exact motions are not bounded, those within which steps add no growth. A missing end is `null`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stability_windows: Option<Vec<[Option<f64>; 2]>>,
    /// The largest time steps of an oscillator that meet the criteria of the request.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub largest_dt: Option<LargestDt>,
    /// The quadratic form that a symplectic step of an oscillator conserves.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub modified_hamiltonian: Option<ModifiedHamiltonian>,
    /// The order of a splitting method by the expansion of its word of kicks and drifts.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub order_of_word: Option<OrderOfWord>,
    /// The largest drift of the energy of an oscillator in all steps, without simulation; none if the initial energy is zero.
    #[serde(flatten)]
    pub drift: Option<Drift>,
    /// The motion from the start without a loop; none of exact steps.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub motion: Option<SteppedMotion>,
    /// The residual that Newton steps of an implicit integrator leave in the motion; none without an iteration.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub newton_residual: Option<NewtonResidual>,
    /// The equilibrium near the start, and the system about it, without a loop.
    #[serde(flatten)]
    pub equilibrium: Option<AboutEquilibrium>,
    /// The stable steps along the motion; none of exact steps.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub steps_along_motion: Option<MotionSteps>,
    /// The verdicts on the step, the motion and the loop.
    pub verdicts: StepVerdicts,
    /// The analysis of the loop, if the request has timing options.
    #[serde(flatten)]
    pub timing: Option<LoopAnalysis>,
}

impl Analysis {
    /// The equilibrium near the start; none with a loop, or if none was found.
    pub fn operating_point(&self) -> Option<&OperatingPoint> {
        self.equilibrium.as_ref()?.operating_point.as_ref()
    }

    /// The system about the equilibrium near the start.
    pub fn linear(&self) -> Option<&LinearAnalysis> {
        self.equilibrium.as_ref()?.linear.as_ref()
    }
}
