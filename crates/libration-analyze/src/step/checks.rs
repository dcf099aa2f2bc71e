//! Checks of a request before any work.

use libration::Float;
use libration::equations::StepProgram;
use libration::simulation::SimulationError;
use libration_settings::limits::{MOST_TURN, find_out_of_range};

use super::{AnalyzeError, Request, Stepping};
use crate::oscillator::CommonOscillator;

/// Fails if the time step or a number of the start is none that a simulation has.
pub(crate) fn check_start(request: &Request) -> Result<(), SimulationError> {
    let (dt, float) = (request.dt, f64::NAME);
    if !(dt.is_finite() && dt > 0.0) {
        return Err(SimulationError::TimeStep { dt, float });
    }
    let mut coordinates = request.system.start().into_iter().enumerate();
    match coordinates.find(|(_, x)| !x.is_finite()) {
        None => Ok(()),
        Some((coordinate, value)) => Err(SimulationError::Start { coordinate, value, float }),
    }
}

/// Fails if the motion turns by more than [`MOST_TURN`] in an exact step.
pub(crate) fn check_turn(
    request: &Request,
    oscillator: Option<CommonOscillator>,
) -> Result<(), AnalyzeError> {
    let Some(CommonOscillator { omega2, gamma }) = oscillator else { return Ok(()) };
    if request.stepping != Stepping::Exact {
        return Ok(());
    }
    let (dt, turn) = (request.dt, omega2.abs().sqrt().max(gamma.abs()) * request.dt);
    if turn > MOST_TURN { Err(AnalyzeError::Turn { dt, turn }) } else { Ok(()) }
}

/// Fails if a parameter or the time step of a loop is too large or too small for the products of floats.
pub(crate) fn check_sizes(request: &Request) -> Result<(), AnalyzeError> {
    if request.timing.feedback.is_none() && !request.timing.draws() {
        return Ok(());
    }
    let dt = find_out_of_range([("dt", request.dt)]).map(|(name, value)| (name, value, ""));
    let parameter = request.compiled().and_then(|system| find_out_of_range(system.parameters()));
    match dt.or(parameter.map(|(name, value)| (name, value, "0, or "))) {
        Some((name, value, zero)) => Err(AnalyzeError::Size { name, value, zero }),
        None => Ok(()),
    }
}

/// Fails if the request has a criterion and its system is no oscillator about the origin with its own energy: a largest time step for
/// another has no closed form.
pub(crate) fn check_criteria(
    request: &Request,
    oscillator: Option<CommonOscillator>,
) -> Result<(), AnalyzeError> {
    let Some(flag) = request.criteria.first() else { return Ok(()) };
    let own = oscillator.filter(|own| own.frequency().is_some());
    match own.and_then(|own| own.energy_of(&request.system)) {
        Some(_) => Ok(()),
        None => Err(AnalyzeError::Criterion { flag, system: request.system.name.clone() }),
    }
}

/// Fails if the request asks exact steps for a criterion, or for a nonlinear system.
pub(crate) fn check_exact(request: &Request) -> Result<(), AnalyzeError> {
    match request.criteria.first() {
        Some(flag) => Err(AnalyzeError::NoLargest { flag }),
        None if !request.system.is_linear() => {
            Err(AnalyzeError::NotLinear { system: request.system.name.clone() })
        }
        None => Ok(()),
    }
}

/// Fails if the request asks implicit steps for a criterion, for a loop, or for more degrees of freedom than they have.
pub(crate) fn check_implicit(request: &Request) -> Result<(), AnalyzeError> {
    let Stepping::Implicit(method) = request.stepping else { return Ok(()) };
    let degrees = request.system.equations.degrees().len();
    let most = StepProgram::most_degrees(method);
    if degrees > most {
        return Err(AnalyzeError::ImplicitDegrees { integrator: method.name(), most, degrees });
    }
    match request.criteria.first().or(request.timing.first()) {
        Some(flag) => Err(AnalyzeError::Implicit { flag, integrator: method.name() }),
        None => Ok(()),
    }
}
