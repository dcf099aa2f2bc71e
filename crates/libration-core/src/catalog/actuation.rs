//! The physical quantity of a command to a system.

use super::AnySystem;

/// The physical quantity of a command: a force where the mass of the system is given, else an acceleration.
///
/// Systems of the catalogue are stepped per unit mass. A caller that closes a loop around one divides
/// forces, and gains that make forces, by [`Actuation::mass`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Actuation {
    /// An acceleration in each degree of freedom.
    #[default]
    Acceleration,
    /// A force: the system is given by its mass and its stiffness.
    Force {
        /// The mass, in kg.
        mass: f64,
        /// The stiffness of the spring, in N/m.
        stiffness: f64,
    },
}

impl Actuation {
    /// `acceleration` or `force`.
    pub fn name(self) -> &'static str {
        match self {
            Actuation::Acceleration => "acceleration",
            Actuation::Force { .. } => "force",
        }
    }

    /// The mass that a command moves, in kg; 1 where commands are accelerations.
    pub fn mass(self) -> f64 {
        match self {
            Actuation::Acceleration => 1.0,
            Actuation::Force { mass, .. } => mass,
        }
    }

    /// The parameters that rebuild `system` together with this: `m` and `k` in place of `omega2` where
    /// commands are forces.
    pub fn parameters(self, system: AnySystem) -> Vec<(&'static str, f64)> {
        let own = system.parameters();
        let Actuation::Force { mass, stiffness } = self else { return own };
        let others = own.into_iter().filter(|(name, _)| *name != "omega2");
        [("m", mass), ("k", stiffness)].into_iter().chain(others).collect()
    }
}
