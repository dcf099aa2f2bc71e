//! Systems of environments, chosen at run time.

use libration::system::{DampedOscillator, Duffing, Oscillator, Pendulum, WithSystem};
use libration::{AnySystem, Elementary, Model, State, System};

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

/// A system with one degree of freedom.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Plant<T> {
    Oscillator(Oscillator<T>),
    Damped(DampedOscillator<T>),
    Pendulum(Pendulum<T>),
    Duffing(Duffing<T>),
}

impl<T: Elementary> Plant<T> {
    pub(super) fn new(SingleDofSystem(system): SingleDofSystem) -> Self {
        match system {
            AnySystem::Oscillator(model) => Plant::Oscillator(Model::<1>::on(&model)),
            AnySystem::DampedOscillator(model) => Plant::Damped(Model::<1>::on(&model)),
            AnySystem::Pendulum(model) => Plant::Pendulum(Model::<1>::on(&model)),
            AnySystem::Duffing(model) => Plant::Duffing(Model::<1>::on(&model)),
            AnySystem::DrivenOscillator(_) | AnySystem::Kepler(_) | AnySystem::HenonHeiles(_) => {
                unreachable!("nothing makes a lone system of {}", system.name())
            }
        }
    }
}

impl<T: Elementary> System<T, 1> for Plant<T> {
    const DISPATCHES: bool = true;

    #[inline(always)]
    fn dispatch<W: WithSystem<T, 1>>(&self, with: W) -> W::Output {
        match *self {
            Plant::Oscillator(system) => with.system(system),
            Plant::Damped(system) => with.system(system),
            Plant::Pendulum(system) => with.system(system),
            Plant::Duffing(system) => with.system(system),
        }
    }

    #[inline]
    fn acceleration(&self, state: &State<T, 1>) -> [T; 1] {
        match self {
            Plant::Oscillator(system) => system.acceleration(state),
            Plant::Damped(system) => system.acceleration(state),
            Plant::Pendulum(system) => system.acceleration(state),
            Plant::Duffing(system) => system.acceleration(state),
        }
    }
}
