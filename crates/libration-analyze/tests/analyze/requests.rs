//! Requests of analyses of systems of the catalogue.

use libration::catalog::Actuation;
use libration::{AnySystem, Method};
use libration_analyze::{Criteria, Request, Timing};
use libration_settings::equations::EquationSystem;

pub(crate) fn request(system: &str, method: Method, dt: f64, q: &[f64], v: &[f64]) -> Request {
    let system = at(AnySystem::build(system, &[] as &[(&str, f64)]).unwrap(), q, v);
    let criteria = Criteria::default();
    let (stepping, timing) = (method.into(), Timing::default());
    Request { system, stepping, dt, steps: 1000, criteria, timing }
}

/// A system of the catalogue at a start.
pub(crate) fn at(system: AnySystem, q: &[f64], v: &[f64]) -> EquationSystem {
    EquationSystem::of_catalogue((system, Actuation::Acceleration), Some(q), Some(v)).unwrap()
}
