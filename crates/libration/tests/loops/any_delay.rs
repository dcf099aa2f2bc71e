//! A delay chosen at run time: loops are compiled once for all of them.

use libration::Float;
use libration::control::delay::{Arrival, Packets, Random, RecordedLatencies};
use libration::control::{ControlError, Delay, StartAddress};

/// A delay of which each trajectory has its own in every step.
#[derive(Clone, Copy)]
pub(crate) enum AnyDelay<'a> {
    Packets(Packets),
    Random(Random<'a>),
    Recorded(RecordedLatencies<'a>),
}

/// The memory of a delay in loops of numbers of type `T`.
type Memory<T, L> = <L as Delay<T>>::Memory;

/// Calls the same method of the delay of any variant.
macro_rules! with {
    ($delay:expr, $chosen:ident => $work:expr) => {
        match $delay {
            AnyDelay::Packets($chosen) => $work,
            AnyDelay::Random($chosen) => $work,
            AnyDelay::Recorded($chosen) => $work,
        }
    };
}

impl<'a, T: Float> Delay<T> for AnyDelay<'a> {
    const SPLITS: usize = 1;

    type Memory = (Memory<T, Packets>, Memory<T, Random<'a>>);
    /// That of recorded latencies.
    type Beat = (u32, T);

    fn check(&self) -> Result<(), ControlError> {
        with!(self, delay => Delay::<T>::check(delay))
    }

    fn longest(&self) -> usize {
        with!(self, delay => Delay::<T>::longest(delay))
    }

    fn start(&self, begin: StartAddress) -> Self::Memory {
        // Of what is not chosen any number will do.
        let (packets, random) = (([T::zero()], [T::zero(); _]), [T::zero()]);
        match self {
            AnyDelay::Packets(delay) => (delay.start(begin), random),
            AnyDelay::Random(delay) => (packets, delay.start(begin)),
            AnyDelay::Recorded(_) => (packets, random),
        }
    }

    fn beat(&self, step: u64) -> (u32, T) {
        match self {
            AnyDelay::Recorded(delay) => delay.beat(step),
            _ => (0, T::zero()),
        }
    }

    fn words(&self) -> usize {
        with!(self, delay => Delay::<T>::words(delay))
    }

    fn steps(&self) -> Option<u64> {
        with!(self, delay => Delay::<T>::steps(delay))
    }

    fn trajectories(&self) -> Option<usize> {
        with!(self, delay => Delay::<T>::trajectories(delay))
    }

    #[inline(always)]
    fn arrival(
        &self,
        (packets, random): &mut Self::Memory,
        beat: (u32, T),
        word: &mut impl FnMut() -> u32,
    ) -> Arrival<T> {
        match self {
            AnyDelay::Packets(delay) => delay.arrival(packets, (), word),
            AnyDelay::Random(delay) => delay.arrival(random, (), word),
            AnyDelay::Recorded(delay) => delay.arrival(&mut [], beat, word),
        }
    }
}
