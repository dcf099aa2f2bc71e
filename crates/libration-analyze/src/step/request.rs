//! Requests for an analysis.

use libration::catalog::Actuation;
use libration::{AnyMethod, AnySystem, ImplicitMethod, Method};
use libration_settings::equations::EquationSystem;

use super::{Criteria, Timing};

/// A step of an integrator to analyse, with criteria and timing options.
#[derive(Clone, Debug)]
pub struct Request {
    /// The system, at its start.
    pub system: EquationSystem,
    /// The integrator, or exact steps.
    pub stepping: Stepping,
    /// The time step, in s.
    pub dt: f64,
    /// Number of steps of the energy drift.
    pub steps: u64,
    /// Criteria for the largest time step.
    pub criteria: Criteria,
    /// Timing options of the control loop.
    pub timing: Timing,
}

impl Request {
    /// The compiled system with the same bits; none of equations in a file.
    pub(crate) fn compiled(&self) -> Option<AnySystem> {
        self.system.twin.map(|twin| twin.system)
    }

    /// The quantity of its commands.
    pub(crate) fn actuation(&self) -> Actuation {
        self.system.twin.map_or(Actuation::Acceleration, |twin| twin.actuation)
    }
}

/// The kind of steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stepping {
    /// Steps of an explicit integrator.
    Method(Method),
    /// Steps of an implicit integrator.
    Implicit(ImplicitMethod),
    /// Exact steps of a linear system: the exponential of its matrix.
    Exact,
}

impl Stepping {
    /// The name of exact steps on the command line.
    pub const EXACT: &'static str = libration::integrator::Exact::NAME;

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Stepping::Method(method) => method.name(),
            Stepping::Implicit(method) => method.name(),
            Stepping::Exact => Stepping::EXACT,
        }
    }

    /// The steps with this name, if they exist.
    pub fn from_name(name: &str) -> Option<Stepping> {
        match name {
            Stepping::EXACT => Some(Stepping::Exact),
            name => AnyMethod::from_name(name).map(Stepping::from),
        }
    }

    /// The explicit integrator; none for implicit and exact steps.
    pub fn method(self) -> Option<Method> {
        match self {
            Stepping::Method(method) => Some(method),
            Stepping::Implicit(_) | Stepping::Exact => None,
        }
    }

    /// The integrator; none for exact steps.
    pub fn any_method(self) -> Option<AnyMethod> {
        match self {
            Stepping::Method(method) => Some(method.into()),
            Stepping::Implicit(method) => Some(method.into()),
            Stepping::Exact => None,
        }
    }
}

impl From<AnyMethod> for Stepping {
    fn from(method: AnyMethod) -> Self {
        match method {
            AnyMethod::Explicit(method) => Stepping::Method(method),
            AnyMethod::Implicit(method) => Stepping::Implicit(method),
        }
    }
}

impl From<Method> for Stepping {
    fn from(method: Method) -> Self {
        Stepping::Method(method)
    }
}
