//! Ensembles: many trajectories of a system, advanced together.
//!
//! There are no SIMD types here, and no second definition of a step. A block of trajectories is
//! copied into local arrays; the innermost loop runs the *scalar* [`Integrator::step`] over its
//! lanes, for all the steps, and the compiler turns that loop into vector registers. It is compiled
//! once for each instruction set; which one runs is decided outside.
//!
//! Nothing is contracted or reordered, so a lane holds the bits of the lone scalar trajectory, for
//! every instruction set, block width, number of threads and number of trajectories.

// Kernels take long to compile, and no unit test needs these.
#[cfg(not(test))]
mod any_ensemble;
mod assign;
#[cfg(not(test))]
mod batch_float;
mod buffer;
mod checkpoint;
#[cfg(not(test))]
mod compiled_oscillator;
mod error;
mod execution;
pub(crate) mod instructions;
#[cfg(not(test))]
mod iterated_program;
pub(crate) mod kernel;
mod loops;
mod memory;
mod observer;
mod planes;
mod run;
pub(crate) mod stream;
mod threaded;

use core::marker::PhantomData;

use bytemuck::Pod;

#[cfg(not(test))]
pub use any_ensemble::{AnyEnsemble, dynamics_of};
pub use assign::{All, Assign, PerTrajectory};
#[cfg(not(test))]
pub use batch_float::BatchFloat;
pub use buffer::{Buffer, Pages};
pub use error::EnsembleError;
pub use execution::{Execution, MOST_THREADS, has_global_threads};
pub use instructions::{InstructionSet, Loop};
pub use loops::{Loops, Setup};
pub use memory::{InsufficientMemory, available_memory, installed_memory};
pub use observer::{Copies, Drift, Lanes, MeanCost, MeanSquareError, Moments, Observer, Summary};
pub use stream::{stream, stream_repeatedly};

use libration_core::{Float, Integrator, State, System};
use planes::{Planes, Share};
use run::Run;
use threaded::{advance_share, threads_for};

/// The most trajectories, and the fewest but for the last ones, that an observer sees from the first step to the
/// last before the next ones.
const CHUNK: [usize; 2] = [512, 4096];

/// Observers among which few trajectories are divided, so that several threads have work.
const OBSERVERS: usize = 16;

/// Trajectories that are never parted where nobody watches: their coordinates fill cache lines, which
/// no two threads then write.
const GRAIN: usize = 64;

/// Steps of the shortest that take as long as a coordinate and its velocity from the memory and back.
const MOVED: u64 = 5;

/// Trajectories of a `D`-dimensional system, as structure of arrays.
#[derive(Debug)]
pub struct Ensemble<T, const D: usize> {
    planes: Planes<T>,
    step: u64,
    execution: Execution,
}

impl<T: Float + Pod, const D: usize> Ensemble<T, D> {
    /// Trajectories that start from `states`, to be run by `execution`.
    ///
    /// # Errors
    /// [`EnsembleError::Memory`].
    pub fn new(states: &[State<T, D>], execution: Execution) -> Result<Self, EnsembleError> {
        Ensemble::from_fn(states.len(), execution, |n| states[n])
    }

    /// `len` trajectories that start from `start(0)`, `start(1)` and so on, to be run by `execution`,
    /// whose threads write the memory that they will work on.
    ///
    /// # Errors
    /// [`EnsembleError::Memory`].
    pub fn from_fn(
        len: usize,
        execution: Execution,
        start: impl Fn(usize) -> State<T, D> + Sync,
    ) -> Result<Self, EnsembleError> {
        let mut planes = Planes::new(2 * D, len)?;
        let count = execution.threads_for(MOVED * D as u64 * len as u64);
        let shares = shares(planes.share(), count, GRAIN);
        execution.each(shares, |mut share| {
            for n in 0..share.len() {
                share.set(n, start(share.first + n));
            }
        });
        Ok(Ensemble { planes, step: 0, execution })
    }

    /// Bytes that `len` trajectories take.
    pub fn bytes(len: usize) -> u128 {
        Planes::<T>::bytes(2 * D, len)
    }

    /// Number of trajectories.
    pub fn len(&self) -> usize {
        self.planes.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Number of steps taken.
    pub fn step(&self) -> u64 {
        self.step
    }

    /// The execution: threads and instruction set.
    pub fn execution(&self) -> &Execution {
        &self.execution
    }

    /// Sets the execution. Results do not depend on it.
    pub fn execute(&mut self, execution: Execution) {
        self.execution = execution;
    }

    /// Position `i` of every trajectory.
    ///
    /// # Panics
    /// If `i` is not below `D`.
    pub fn q(&self, i: usize) -> &[T] {
        assert!(i < D, "position {i} of {D}");
        self.planes.plane_of(i)
    }

    /// Velocity `i` of every trajectory.
    ///
    /// # Panics
    /// If `i` is not below `D`.
    pub fn v(&self, i: usize) -> &[T] {
        assert!(i < D, "velocity {i} of {D}");
        self.planes.plane_of(D + i)
    }

    /// Trajectory `n`, if there is one.
    pub fn state(&self, n: usize) -> Option<State<T, D>> {
        (n < self.len()).then(|| State {
            q: core::array::from_fn(|i| self.q(i)[n]),
            v: core::array::from_fn(|i| self.v(i)[n]),
        })
    }

    /// The trajectories with a coordinate that is infinite or not a number, in order.
    pub fn not_finite(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.len()).filter(|&n| (0..2 * D).any(|i| !self.planes.plane_of(i)[n].is_finite()))
    }

    /// Takes `steps` steps of `dt` with every trajectory, all of them in one pass over the memory.
    ///
    /// # Errors
    /// [`EnsembleError::Length`] if there are more or fewer systems or time steps than trajectories.
    pub fn advance<Sys: System<T, D> + Copy + Send + Sync>(
        &mut self,
        method: impl Integrator,
        systems: impl Assign<Sys>,
        dt: impl Assign<T>,
        steps: u64,
    ) -> Result<(), EnsembleError> {
        self.check::<Sys>(systems, dt)?;
        let range = self.step..self.step.saturating_add(steps);
        advance_share(self.planes.share(), &self.execution, method, systems, dt, &range);
        self.step = range.end;
        Ok(())
    }

    /// [`Ensemble::advance`] under the eyes of observers, which are returned in the order of their
    /// trajectories.
    ///
    /// Each observer is made by `observer` for a run of neighbouring trajectories, of which it sees
    /// blocks, one after the other: each from its start (if no step has been taken before) through
    /// every step whose number is a multiple of `every`.
    ///
    /// # Errors
    /// [`EnsembleError::Length`] as for `advance`; [`EnsembleError::Every`] if `every` is 0.
    pub fn observe<Sys: System<T, D> + Copy + Send + Sync, O: Observer<T, D>>(
        &mut self,
        method: impl Integrator,
        systems: impl Assign<Sys>,
        dt: impl Assign<T>,
        steps: u64,
        every: u64,
        observer: impl Fn(core::ops::Range<usize>) -> O + Sync,
    ) -> Result<Vec<O>, EnsembleError> {
        self.check::<Sys>(systems, dt)?;
        if every == 0 {
            return Err(EnsembleError::Every);
        }
        let range = self.step..self.step.saturating_add(steps);
        let instructions = self.execution.instruction_set();
        let count = self.threads_for::<_, Sys>(method, steps);
        let chunk = chunk(self.len());
        let shares = shares(self.planes.share(), count, chunk);
        let observers = self.execution.each(shares, |mut share| {
            let mut observers = Vec::new();
            while share.len() > 0 {
                let share = share.split_off(chunk);
                let mut sees = observer(share.first..share.first + share.len());
                let steps = range.clone();
                let system = PhantomData::<(T, Sys)>;
                let watch = Some((every, &mut sees));
                instructions.run(Run { share, method, systems, dt, steps, watch, system });
                observers.push(sees);
            }
            observers
        });
        self.step = range.end;
        Ok(observers.into_iter().flatten().collect())
    }

    /// The number of threads for so many steps of `M` on `Sys`.
    fn threads_for<M: Integrator, Sys: System<T, D>>(&self, _: M, steps: u64) -> usize {
        threads_for::<T, M, Sys, D>(&self.execution, self.len(), steps)
    }

    fn check<Sys>(
        &self,
        systems: impl Assign<Sys>,
        dt: impl Assign<T>,
    ) -> Result<(), EnsembleError> {
        for (what, values) in [("systems", systems.count()), ("time steps", dt.count())] {
            if let Some(values) = values.filter(|&values| values != self.len()) {
                return Err(EnsembleError::Length { what, values, len: self.len() });
            }
        }
        Ok(())
    }
}

/// Trajectories of an observer: the same for every instruction set and number of threads, so that what
/// observers add up is.
fn chunk(len: usize) -> usize {
    let [least, most] = CHUNK;
    (len / OBSERVERS).next_multiple_of(GRAIN).clamp(least, most)
}

/// The observer where there is none.
struct NoObserver;

impl<T, const D: usize> Observer<T, D> for NoObserver {
    const WATCHES: bool = false;

    fn observe(&mut self, _: &Lanes<'_, T, D>) {}
}

/// At most `count` shares of about equal size, each of whole grains but the last.
fn shares<T: Copy, const D: usize>(
    mut all: Share<'_, T, D>,
    count: usize,
    grain: usize,
) -> Vec<Share<'_, T, D>> {
    let size = all.len().div_ceil(count).next_multiple_of(grain).max(1);
    let mut shares = Vec::with_capacity(count);
    while all.len() > 0 {
        shares.push(all.split_off(size));
    }
    shares
}
