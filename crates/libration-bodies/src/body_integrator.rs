//! Integrators of bodies.

use libration_core::Method;

use super::step_plan::StepPlan;

/// How bodies move during a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BodyIntegrator {
    /// An integrator in inertial coordinates.
    Method(Method),
    /// Orbits around the first body, which must be the heaviest, and kicks by all other forces: the splitting of Wisdom and Holman in
    /// democratic heliocentric coordinates. Order 2, with errors in proportion to the masses of the others.
    WisdomHolman,
}

impl BodyIntegrator {
    /// Name on the command line and in Python.
    pub const fn name(self) -> &'static str {
        match self {
            BodyIntegrator::Method(method) => method.name(),
            BodyIntegrator::WisdomHolman => "wisdom-holman",
        }
    }

    /// The integrator of that name, if there is one.
    pub fn from_name(name: &str) -> Option<Self> {
        if name == BodyIntegrator::WisdomHolman.name() {
            return Some(BodyIntegrator::WisdomHolman);
        }
        Method::from_name(name).map(BodyIntegrator::Method)
    }

    /// Accelerations that a step evaluates: sums over all pairs.
    pub fn evaluations(self) -> usize {
        match self {
            BodyIntegrator::Method(method) => StepPlan::new(method, 1.0).evaluations,
            BodyIntegrator::WisdomHolman => 1,
        }
    }

    /// Order of consistency.
    pub const fn order(self) -> u32 {
        match self {
            BodyIntegrator::Method(method) => method.order(),
            BodyIntegrator::WisdomHolman => 2,
        }
    }
}
