//! What is to be analysed.

use libration::catalog::Actuation;
use libration::{AnySystem, Method};

use super::{Criteria, Timing};

/// What is to be analysed.
#[derive(Clone, Debug)]
pub struct Request {
    /// The system.
    pub system: AnySystem,
    /// The quantity of its commands.
    pub actuation: Actuation,
    /// How steps are taken.
    pub stepping: Stepping,
    /// The time step, in s.
    pub dt: f64,
    /// Positions at the start.
    pub q: Vec<f64>,
    /// Velocities at the start.
    pub v: Vec<f64>,
    /// Number of steps over which the energy drift is taken.
    pub steps: u64,
    /// What the largest time step is asked for.
    pub criteria: Criteria,
    /// What is asked of timing.
    pub timing: Timing,
}

/// How steps are taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stepping {
    /// By an integrator.
    Method(Method),
    /// Without error, which exists of linear systems: by the exponential of their matrix.
    Exact,
}

impl Stepping {
    /// The name of exact steps on the command line.
    pub const EXACT: &'static str = libration::integrator::Exact::NAME;

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Stepping::Method(method) => method.name(),
            Stepping::Exact => Stepping::EXACT,
        }
    }

    /// What has this name.
    pub fn from_name(name: &str) -> Option<Stepping> {
        match name {
            Stepping::EXACT => Some(Stepping::Exact),
            name => Method::from_name(name).map(Stepping::Method),
        }
    }

    /// The integrator, if there is one.
    pub fn method(self) -> Option<Method> {
        match self {
            Stepping::Method(method) => Some(method),
            Stepping::Exact => None,
        }
    }
}

impl From<Method> for Stepping {
    fn from(method: Method) -> Self {
        Stepping::Method(method)
    }
}
