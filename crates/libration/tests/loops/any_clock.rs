//! A clock chosen at run time: loops are compiled once for all of them.

use libration::control::{Clock, ControlError, Memory, StartAddress};

/// The largest memory of a clock.
const MEMORY: usize = 4;

/// Any clock, called for every step of every trajectory.
#[derive(Clone, Copy)]
pub(crate) struct AnyClock<'a>(pub(crate) &'a dyn DynClock);

/// A [`Clock`] without its types.
pub(crate) trait DynClock: Send + Sync {
    fn check(&self) -> Result<(), ControlError>;
    fn start(&self, begin: StartAddress) -> [f64; MEMORY];
    fn words(&self) -> usize;
    fn steps(&self) -> Option<u64>;
    fn trajectories(&self) -> Option<usize>;
    fn ratio(&self, memory: &mut [f64; MEMORY], step: u64, word: &mut dyn FnMut() -> u32) -> f64;
}

/// Writes a memory to its numbers.
fn store<M: Memory<f64>>(memory: M, to: &mut [f64; MEMORY]) {
    const { assert!(M::LEN <= MEMORY) };
    M::store(&memory.single_lane(), &mut |i, &[number]| to[i] = number);
}

impl<C: Clock<f64>> DynClock for C {
    fn check(&self) -> Result<(), ControlError> {
        Clock::check(self)
    }

    fn start(&self, begin: StartAddress) -> [f64; MEMORY] {
        let mut numbers = [0.0; MEMORY];
        store(Clock::start(self, begin), &mut numbers);
        numbers
    }

    fn words(&self) -> usize {
        Clock::words(self)
    }

    fn steps(&self) -> Option<u64> {
        Clock::steps(self)
    }

    fn trajectories(&self) -> Option<usize> {
        Clock::trajectories(self)
    }

    fn ratio(&self, numbers: &mut [f64; MEMORY], step: u64, word: &mut dyn FnMut() -> u32) -> f64 {
        let lanes = C::Memory::load(&|i| [numbers[i]]);
        let mut memory = C::Memory::lane(&lanes, 0);
        let ratio = Clock::ratio(self, &mut memory, self.beat(step), &mut || word());
        store(memory, numbers);
        ratio
    }
}

impl Clock<f64> for AnyClock<'_> {
    type Memory = [f64; MEMORY];
    type Beat = u64;

    const DRAWS: bool = true;

    fn check(&self) -> Result<(), ControlError> {
        self.0.check()
    }

    fn start(&self, begin: StartAddress) -> [f64; MEMORY] {
        self.0.start(begin)
    }

    fn beat(&self, step: u64) -> u64 {
        step
    }

    fn words(&self) -> usize {
        self.0.words()
    }

    fn steps(&self) -> Option<u64> {
        self.0.steps()
    }

    fn trajectories(&self) -> Option<usize> {
        self.0.trajectories()
    }

    fn ratio(&self, memory: &mut [f64; MEMORY], step: u64, word: &mut impl FnMut() -> u32) -> f64 {
        self.0.ratio(memory, step, word)
    }
}
