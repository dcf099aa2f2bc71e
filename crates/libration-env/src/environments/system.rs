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
pub(super) enum EnvironmentSystem<T> {
    Oscillator(Oscillator<T>),
    Damped(DampedOscillator<T>),
    Pendulum(Pendulum<T>),
    Duffing(Duffing<T>),
}

impl<T: Elementary> EnvironmentSystem<T> {
    pub(super) fn new(SingleDofSystem(system): SingleDofSystem) -> Self {
        match system {
            AnySystem::Oscillator(model) => EnvironmentSystem::Oscillator(Model::<1>::on(&model)),
            AnySystem::DampedOscillator(model) => EnvironmentSystem::Damped(Model::<1>::on(&model)),
            AnySystem::Pendulum(model) => EnvironmentSystem::Pendulum(Model::<1>::on(&model)),
            AnySystem::Duffing(model) => EnvironmentSystem::Duffing(Model::<1>::on(&model)),
            AnySystem::DrivenOscillator(_) | AnySystem::Kepler(_) | AnySystem::HenonHeiles(_) => {
                unreachable!("nothing makes a lone system of {}", system.name())
            }
        }
    }
}

impl<T: Elementary> System<T, 1> for EnvironmentSystem<T> {
    const DISPATCHES: bool = true;

    #[inline(always)]
    fn dispatch<W: WithSystem<T, 1>>(&self, with: W) -> W::Output {
        match *self {
            EnvironmentSystem::Oscillator(system) => with.system(system),
            EnvironmentSystem::Damped(system) => with.system(system),
            EnvironmentSystem::Pendulum(system) => with.system(system),
            EnvironmentSystem::Duffing(system) => with.system(system),
        }
    }

    #[inline]
    fn acceleration(&self, state: &State<T, 1>) -> [T; 1] {
        match self {
            EnvironmentSystem::Oscillator(system) => system.acceleration(state),
            EnvironmentSystem::Damped(system) => system.acceleration(state),
            EnvironmentSystem::Pendulum(system) => system.acceleration(state),
            EnvironmentSystem::Duffing(system) => system.acceleration(state),
        }
    }
}
