//! Integrators of bodies.

use libration_core::Method;
use libration_core::integrator::{SplittingScope, SplittingTable};

use super::step_plan::StepPlan;

/// How bodies move during a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BodyIntegrator {
    /// An integrator in inertial coordinates.
    Method(Method),
    /// Orbits around the first body, which must be the heaviest, and kicks by all other forces: the splitting of Wisdom and Holman in
    /// democratic heliocentric coordinates.
    WisdomHolman(OrbitsAndKicks),
}

/// The order in which orbits and kicks follow each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OrbitsAndKicks {
    /// Half a kick, an orbit, half a kick: order 2, with errors in proportion to the masses of the others.
    Leapfrog,
    /// A published table for weak kicks: errors that are linear in the masses of the others have a higher order than those that are
    /// quadratic (J. Laskar, P. Robutel, *Celestial Mechanics and Dynamical Astronomy* 80, 2001).
    Table(&'static SplittingTable),
}

/// The name of the splitting, which that of a table may follow.
const WISDOM_HOLMAN: &str = "wisdom-holman";

impl BodyIntegrator {
    /// All splittings around a heavy first body.
    pub fn wisdom_holman() -> impl Iterator<Item = BodyIntegrator> {
        let weak = |table: &&'static SplittingTable| {
            matches!(table.scope, SplittingScope::NearlyIntegrable { .. })
        };
        let tables = SplittingTable::ALL.into_iter().flatten().filter(weak);
        core::iter::once(OrbitsAndKicks::Leapfrog)
            .chain(tables.map(OrbitsAndKicks::Table))
            .map(BodyIntegrator::WisdomHolman)
    }

    /// Name on the command line and in Python: for a table that of the splitting, a colon, and that of the table.
    pub fn name(self) -> String {
        match self {
            BodyIntegrator::Method(method) => method.name().to_owned(),
            BodyIntegrator::WisdomHolman(OrbitsAndKicks::Leapfrog) => WISDOM_HOLMAN.to_owned(),
            BodyIntegrator::WisdomHolman(OrbitsAndKicks::Table(table)) => {
                format!("{WISDOM_HOLMAN}:{}", table.name)
            }
        }
    }

    /// The integrator of that name, if there is one.
    pub fn from_name(name: &str) -> Option<Self> {
        if name.starts_with(WISDOM_HOLMAN) {
            return BodyIntegrator::wisdom_holman().find(|known| known.name() == name);
        }
        Method::from_name(name).map(BodyIntegrator::Method)
    }

    /// Accelerations that a step evaluates: sums over all pairs.
    pub fn evaluations(self) -> usize {
        match self {
            BodyIntegrator::Method(method) => StepPlan::new(method, 1.0).evaluations,
            BodyIntegrator::WisdomHolman(OrbitsAndKicks::Leapfrog) => 1,
            BodyIntegrator::WisdomHolman(OrbitsAndKicks::Table(table)) => {
                table.coefficients.kicks()
            }
        }
    }

    /// Order of consistency.
    pub const fn order(self) -> u32 {
        match self {
            BodyIntegrator::Method(method) => method.order(),
            BodyIntegrator::WisdomHolman(OrbitsAndKicks::Leapfrog) => 2,
            BodyIntegrator::WisdomHolman(OrbitsAndKicks::Table(table)) => table.order,
        }
    }
}
