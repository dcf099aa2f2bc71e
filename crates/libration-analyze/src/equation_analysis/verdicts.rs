//! Verdicts on steps of systems by equations.

use libration::AnyMethod;
use libration::analysis::jacobian;
use libration::equations::StepProgram;
use libration::linear::{Complex64, eigenvalues};
use libration_report::verdict::{Outcome, Verdict};
use libration_settings::equations::EquationSystem;
use serde::Serialize;

use super::motion::is_affine;
use super::step::spectral_radius;
use super::{EquationMotion, MotionSteps};
use crate::linear_analysis::LinearAnalysis;
use crate::step::of_rest;
use crate::step_verdict::{StepGrowth, has_multiple};

/// The verdicts on a system by equations.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EquationVerdicts {
    /// Whether the step lets deviations from the equilibrium, or of a linear system from any motion, grow more than exact steps do. None
    /// without an equilibrium near the motion, where rounding hides the growth, and where the step is stable along a motion that stays away
    /// from the equilibrium.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub step: Option<Verdict>,
    /// Whether the steps resolve the motion; none of a system that rests at its start, if the step has a verdict.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub motion: Option<Verdict>,
}

impl EquationVerdicts {
    pub(super) fn new(
        system: &EquationSystem,
        method: AnyMethod,
        motion: &EquationMotion,
        equilibrium: Option<&[f64]>,
        linear: Option<&LinearAnalysis>,
        along: &MotionSteps,
    ) -> Self {
        let places = system.states.iter().map(|state| state.place);
        let is_relevant = |at: &[f64]| {
            is_affine(system)
                || (motion.examination.is_near(at, places.clone()) && !along.allows(motion.dt))
        };
        let step = match (equilibrium.filter(|at| is_relevant(at)), linear) {
            (Some(_), Some(linear)) => about_equilibrium(motion, linear),
            _ if is_affine(system) => of_affine(system, method, motion.dt),
            _ => None,
        };
        if let (Some(step), true) = (&step, motion.examination.is_at_rest()) {
            return EquationVerdicts { step: Some(of_rest(step)), motion: None };
        }
        // The motion shows what rounding hides at the equilibrium, and whether steps follow a growing mode for as long as it is asked for.
        let is_decided =
            |verdict: &Verdict| !matches!(verdict.outcome, Outcome::Unknown | Outcome::NotResolved);
        let step = step.filter(is_decided);
        EquationVerdicts { step, motion: Some(motion.examination.verdict.clone()) }
    }

    /// All that there are.
    pub fn all(&self) -> impl Iterator<Item = &Verdict> {
        self.step.iter().chain(&self.motion)
    }

    /// Whether an instability of the step is known.
    pub fn is_unstable(&self) -> bool {
        self.step.as_ref().is_some_and(|verdict| verdict.outcome == Outcome::Unstable)
    }
}

fn about_equilibrium(motion: &EquationMotion, linear: &LinearAnalysis) -> Option<Verdict> {
    let own = linear.steps.iter().find(|step| step.integrator == motion.integrator);
    if let Some(verdict) = own.and_then(|step| step.verdict.clone()) {
        return Some(verdict);
    }
    let growth = StepGrowth {
        dt: motion.dt,
        radius: Some(motion.spectral_radius?),
        exact_rate: linear.modes.first()?.growth_rate,
        has_parted: linear.modes.iter().any(|mode| mode.natural_frequency == 0.0)
            || has_multiple(
                linear
                    .modes
                    .iter()
                    .map(|mode| Complex64::new(mode.eigenvalue[0], mode.eigenvalue[1])),
            ),
        stable_dt: None,
        has_stability_function: false,
        modes: Vec::new(),
    };
    Some(growth.verdict())
}

/// The step of a linear system without an equilibrium: its derivatives are the same everywhere.
fn of_affine(system: &EquationSystem, method: AnyMethod, dt: f64) -> Option<Verdict> {
    let step = StepProgram::of(method, system.equations.dynamics());
    let start = system.start();
    let rates = jacobian(system.equations.dynamics(), &start);
    let values = eigenvalues(&system.state_matrix(&rates))?;
    let growth = StepGrowth {
        dt,
        radius: Some(spectral_radius(&step, system, &start, dt)?),
        exact_rate: values.iter().map(|value| value.re).fold(f64::NEG_INFINITY, f64::max),
        // Without an equilibrium there is one.
        has_parted: true,
        stable_dt: None,
        has_stability_function: false,
        modes: Vec::new(),
    };
    Some(growth.verdict())
}
