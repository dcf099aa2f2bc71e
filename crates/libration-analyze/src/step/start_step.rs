//! A step from the start of a system as a matrix, and the energy that steps of an oscillator lose.

use libration::analysis::{DriftForecast, Linearisation, QuadraticForm};
use libration::equations::{Degree, StepProgram};
use libration::number::Wide;
use libration::{AnySystem, Scalar, State};

use super::step_matrix::is_undefined;
use super::{AnalyzeError, Drift, Request};

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
    /// [`AnalyzeError::Singular`] where the force of a system by name has no value.
    pub(crate) fn new(request: &Request) -> Result<Option<Self>, AnalyzeError> {
        let system = &request.system;
        let degrees = system.equations.degrees();
        if degrees.iter().any(|degree| matches!(degree, Degree::State(_)))
            || degrees.len() > MOST_DEGREES
        {
            return Ok(None);
        }
        let (dynamics, start) = (system.equations.dynamics(), system.start());
        let Some(method) = request.stepping.any_method() else {
            let linear = Linearisation::exact(dynamics, &start, request.dt);
            return Ok(Some(StartStep { linear, evaluations: 0 }));
        };
        let program = StepProgram::of(method, dynamics);
        let linear = Linearisation::new(&program, dynamics, &start, request.dt);
        let is_singular = [&linear.generator, &linear.step, &linear.back].map(is_undefined);
        match (is_singular, system.twin) {
            ([_, true, _], Some(_)) => {
                let (q, v) = (system.q.clone(), system.v.clone());
                Err(AnalyzeError::Singular { allowed: regular_starts(request.compiled()), q, v })
            }
            ([false, false, false], _) => {
                Ok(Some(StartStep { linear, evaluations: program.evaluations() as u64 }))
            }
            _ => Ok(None),
        }
    }

    /// The drift of the energy of a common oscillator; none if it begins at zero, or if the energy is not that of a spring in each degree
    /// of freedom.
    pub(crate) fn drift(&self, request: &Request) -> Option<Drift> {
        let system = &request.system;
        let (dynamics, start) = (system.equations.dynamics(), system.start());
        let degrees = dynamics.degrees();
        let mut origin = vec![0.0; 2 * degrees];
        origin.extend_from_slice(&start[2 * degrees..]);
        let mut forces = dynamics.accelerations().on::<f64>();
        if forces.run(&origin).any(|force| force != 0.0) {
            return None;
        }
        let program = dynamics.energy()?;
        let wide = |state: &[f64]| state.iter().map(|&x| Wide::from_f64(x)).collect::<Vec<_>>();
        let energy = QuadraticForm::of(|state: &State<Wide, 1>| {
            let mut all = wide(&origin);
            (all[0], all[degrees]) = (state.q[0], state.v[0]);
            program.on().run(&all).next().unwrap_or(Wide::ZERO)
        });
        let mut own = program.on::<f64>();
        let is_sum = |scale: f64| {
            let state: Vec<f64> = (0..2 * degrees).map(|i| scale + (i as f64).sin()).collect();
            let all: Vec<f64> = state.iter().chain(&start[2 * degrees..]).copied().collect();
            let parts = (0..degrees).map(|i| {
                let at = State { q: [state[i]], v: [state[degrees + i]] };
                energy.at(&at.map(Wide::from_f64)).to_f64()
            });
            let (sum, own) = (parts.sum::<f64>(), own.run(&all).next().unwrap_or(f64::NAN));
            (own - sum).abs() <= SAME * sum.abs()
        };
        // A polynomial that is another differs at one of three points that have nothing to do with it.
        if ![1.3, -0.7, 2.9].into_iter().all(is_sum) {
            return None;
        }
        let starts = system.q.iter().zip(&system.v).map(|(&q, &v)| State { q: [q], v: [v] });
        let starts: Vec<State<f64, 1>> = starts.collect();
        let step = self.linear.step.decoupled()?.into_iter().next()?;
        DriftForecast::of_orbits(&energy, &step, &starts, request.steps).map(Drift::from)
    }
}

/// Roundings of a sum of a few products.
const SAME: f64 = 1e-12;

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
