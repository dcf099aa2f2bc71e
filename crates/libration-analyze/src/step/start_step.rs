//! A step from the start of a system as a matrix, and the energy that steps of an oscillator lose.

use libration::analysis::{DriftForecast, Linearisation};
use libration::equations::{Degree, StepProgram};
use libration::{AnySystem, State};

use super::step_matrix::is_undefined;
use super::{AnalyzeError, Drift, Request};
use crate::oscillator::CommonOscillator;

/// Most degrees of freedom of a matrix: the time of its eigenvalues grows with the fourth power.
const MOST_DEGREES: usize = 8;

/// A step from the start, linearised there with 1024 bits.
pub(crate) struct StartStep {
    pub(crate) linear: Linearisation,
    /// Force evaluations of a step.
    pub(crate) evaluations: u64,
}

impl StartStep {
    /// The step of a request, by its program. None of systems with states of first order, of more than eight degrees of freedom, and where
    /// the step has no derivative.
    ///
    /// # Errors
    /// [`AnalyzeError::Singular`] where the force has no value, or of a system by name no derivative.
    pub(crate) fn new(request: &Request) -> Result<Option<Self>, AnalyzeError> {
        let system = &request.system;
        let (dynamics, start) = (system.equations.dynamics(), system.start());
        let singular = || {
            let (q, v) = (system.q.clone(), system.v.clone());
            AnalyzeError::Singular { allowed: regular_starts(request.compiled()), q, v }
        };
        if dynamics.accelerations().on::<f64>().run(&start).any(|force| !force.is_finite()) {
            return Err(singular());
        }
        let degrees = system.equations.degrees();
        if degrees.iter().any(|degree| matches!(degree, Degree::State(_)))
            || degrees.len() > MOST_DEGREES
        {
            return Ok(None);
        }
        let Some(method) = request.stepping.any_method() else {
            let linear = Linearisation::exact(dynamics, &start, request.dt);
            return Ok(Some(StartStep { linear, evaluations: 0 }));
        };
        let program = StepProgram::of(method, dynamics);
        let linear = Linearisation::new(&program, dynamics, &start, request.dt);
        let is_singular = [&linear.generator, &linear.step, &linear.back].map(is_undefined);
        match (is_singular, system.twin) {
            ([_, true, _], Some(_)) => Err(singular()),
            ([false, false, false], _) => {
                Ok(Some(StartStep { linear, evaluations: program.evaluations() as u64 }))
            }
            _ => Ok(None),
        }
    }

    /// The drift of the energy of a common oscillator; none if it begins at zero, or if the energy is not that of the oscillator.
    pub(crate) fn drift(&self, request: &Request, oscillator: CommonOscillator) -> Option<Drift> {
        let system = &request.system;
        let energy = oscillator.energy_of(system)?;
        let starts = system.q.iter().zip(&system.v).map(|(&q, &v)| State { q: [q], v: [v] });
        let starts: Vec<State<f64, 1>> = starts.collect();
        let step = self.linear.step.decoupled()?.into_iter().next()?;
        DriftForecast::of_orbits(&energy, &step, &starts, request.steps).map(Drift::from)
    }
}

/// The starts at which the force of a system has a derivative, in words.
fn regular_starts(system: Option<AnySystem>) -> &'static str {
    match system {
        Some(AnySystem::Kepler(_)) => {
            "--q must not be the origin, where the attraction has no bound"
        }
        Some(AnySystem::Pendulum(_) | AnySystem::DrivenOscillator(_)) => {
            "coordinates must stay so small that angles are below 10¹⁵⁴ rad"
        }
        _ => "coordinates must stay within the range of floats",
    }
}
