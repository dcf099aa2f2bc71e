//! Systems of environments, chosen at run time.

use libration::AnySystem;

/// A system of the catalogue that has one degree of freedom.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SingleDofSystem(AnySystem);

impl SingleDofSystem {
    /// The system, if it has one degree of freedom.
    pub fn new(system: AnySystem) -> Option<Self> {
        match system {
            AnySystem::Oscillator(_)
            | AnySystem::DampedOscillator(_)
            | AnySystem::Pendulum(_)
            | AnySystem::Duffing(_) => Some(SingleDofSystem(system)),
            AnySystem::DrivenOscillator(_) | AnySystem::Kepler(_) | AnySystem::HenonHeiles(_) => {
                None
            }
        }
    }

    /// The system as [`AnySystem`].
    pub fn any(self) -> AnySystem {
        self.0
    }
}
