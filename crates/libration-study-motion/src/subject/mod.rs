//! Subjects of studies: systems of the catalogue or of the user.

mod catalogue;
mod energy;
mod equations;
mod errors;
mod measurements;
mod orbit;
mod orbits;
mod portrait;
mod problem;
mod rounding;
pub(crate) mod settings;
mod stability;
mod sweep;
mod symmetry;

pub use self::catalogue::SYSTEMS;
pub(crate) use self::catalogue::configured;
pub use self::energy::{Change, Changes, Horizon};
pub use self::errors::{Errors, Kind};
pub use self::orbits::Orbits;
pub use self::portrait::Portrait;
pub use self::problem::{Problem, StudiedState};
pub use self::stability::StabilityLimit;
pub(crate) use self::symmetry::ROUNDING;
pub use self::symmetry::Symmetry;

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
    /// Whether its derivatives by positions are symmetric: the system is then Hamiltonian with velocities as momenta, and the form `J`
    /// of positions and velocities is the one to be kept.
    pub has_potential: bool,
}
