//! Subjects of studies: systems of the catalogue or of the user.

mod catalogue;
mod energy;
mod errors;
mod flow;
mod measurements;
mod orbit;
mod orbits;
mod portrait;
mod problem;
pub(crate) mod settings;
mod stability;
mod sweep;
mod symmetry;

use libration::Method;
use libration::ensemble::Execution;

pub use self::catalogue::SYSTEMS;
pub(crate) use self::catalogue::configured;
pub use self::energy::{Change, Changes, Horizon};
pub use self::errors::{Errors, Kind};
pub use self::orbits::Orbits;
pub use self::portrait::Portrait;
pub use self::problem::Problem;
pub(super) use self::stability::StabilityLimit;
pub(crate) use self::symmetry::ROUNDING;
pub use self::symmetry::Symmetry;
use libration_study::StudyError;

/// Powers of two by which a time step is divided, in turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Halvings {
    /// Steps a turn at the largest time step, a multiple of [`SAMPLES`](Halvings::SAMPLES).
    pub coarsest: u64,
    /// Steps a turn beyond which no time step is halved.
    pub finest: u64,
}

impl Halvings {
    /// Samples a turn at which orbits are compared: each is a step of every time step.
    pub const SAMPLES: u64 = 16;

    /// The numbers of steps a turn, rising.
    pub fn steps(self) -> impl Iterator<Item = u64> {
        let double = |&n: &u64| n.checked_mul(2);
        std::iter::successors(Some(self.coarsest), double).take_while(move |&n| n <= self.finest)
    }
}

/// Properties of the acceleration of a system, from its Jacobian along the orbit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Law {
    /// Whether the acceleration is linear in `(q, v)`.
    pub linear: bool,
    /// Whether it depends on the velocity; a kick is then no exact flow.
    pub velocity_dependent: bool,
}

/// A system with its start, to which every instrument of the laboratory can be put.
///
/// [`Problem`] is one for any [`Model`](libration::Model).
pub trait Subject: Sync {
    /// Name in identifiers and files, as in `pendulum`.
    fn name(&self) -> &str;

    /// Name in running text.
    fn title(&self) -> &str;

    /// Degrees of freedom.
    fn dimension(&self) -> usize;

    /// About the time that one revolution takes, in s; time steps are given as fractions of it.
    fn turn(&self) -> f64;

    /// Returns the properties of the acceleration.
    fn law(&self) -> Law;

    /// How far the reference orbit may be off, relative to the size of the orbit: the largest
    /// difference from the same with half the step.
    fn reference_error(&self) -> f64;

    /// Returns the errors of `method` at halved steps, until their order settles.
    ///
    /// # Errors
    /// If no time step or start is possible.
    fn errors(&self, kind: Kind, method: Method, halvings: Halvings) -> Result<Errors, StudyError>;

    /// Returns the change of the energy with `method` at halved steps, until the order settles.
    ///
    /// # Errors
    /// If no time step or start is possible.
    fn changes(
        &self,
        change: Change,
        method: Method,
        halvings: Halvings,
    ) -> Result<Changes, StudyError>;

    /// The running maximum of the energy drift over `turns` turns of `steps` steps.
    ///
    /// # Errors
    /// If no time step or start is possible.
    fn horizon(&self, method: Method, steps: u64, turns: u64) -> Result<Horizon, StudyError>;

    /// Whether the orbit is closed: what is odd under time reversal averages out over it.
    fn closes(&self) -> bool;

    /// The highest angular frequency of small oscillations about the equilibrium, in rad/s.
    fn frequency(&self) -> Option<f64>;

    /// Up to which time step no orbit of `steps` steps is lost; none if nothing is lost however large
    /// the step.
    ///
    /// # Errors
    /// If the system refuses the memory for the orbits that are tried together.
    fn stability_limit(
        &self,
        execution: &Execution,
        orbits: Orbits,
        method: Method,
        steps: u64,
    ) -> Result<Option<StabilityLimit>, StudyError>;

    /// The first `steps` points of the orbit at a time step `dt`.
    ///
    /// # Errors
    /// If no time step or start is possible.
    fn portrait(&self, method: Method, dt: f64, steps: u64) -> Result<Portrait, StudyError>;

    /// The defects of one step at `steps` steps a turn, the root of their mean square along the
    /// orbit, in 1024 bits.
    fn symmetry(&self, method: Method, steps: u64) -> Symmetry;
}
