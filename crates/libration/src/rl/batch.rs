//! Many environments.

use core::marker::PhantomData;

use bytemuck::Pod;

use super::kernel::{Horizon, TILE};
use super::{Environment, Policy, Rollout, Start, Task};
use crate::ensemble::{Assign, Buffer, EnsembleError, Execution, Pages};
use crate::{Float, Integrator, State, System};

/// The end of an episode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Final<T, const O: usize> {
    /// In which step of the rollout.
    pub step: usize,
    /// Of which environment.
    pub environment: usize,
    /// What was seen last, before the next episode began.
    pub observation: [T; O],
    /// What the episode paid in all.
    pub episode_return: T,
    /// Its actions.
    pub length: u32,
}

/// Environments that are stepped together. Where an episode ends another begins in the same step: what is seen next is its
/// start, and what was seen last is kept (`Final`).
///
/// ```
/// use libration::State;
/// use libration::ensemble::{All, Execution};
/// use libration::integrator::SymplecticEuler;
/// use libration::rl::policy::Linear;
/// use libration::rl::{Environment, Environments, Layout, Rollout, Writes};
/// use libration::rl::{start::Between, task::Regulate};
/// use libration::system::Oscillator;
///
/// # fn main() -> Result<(), libration::ensemble::EnsembleError> {
/// let environment = Environment {
///     systems: All(Oscillator { omega2: 10.0_f32 }),
///     method: SymplecticEuler,
///     dt: 0.01,
///     substeps: 1,
///     task: Regulate { position: 1.0, velocity: 0.1, effort: 0.0, bound: 10.0 },
///     start: Between(State { q: [-1.0], v: [0.0] }, State { q: [1.0], v: [0.0] }),
///     limit: Some(200),
/// };
/// let mut all = Environments::new(environment, 1000, 7, Execution::serial())?;
/// let policy = Linear { weights: [[-10.0, -2.0]], bias: [0.0] };
/// let mut rollout = Rollout::new(256, 1000, true, Layout::Interleaved, Writes::Plain)?;
/// all.rollout(policy, &mut rollout)?;
/// // Every episode was cut off once, and none was lost.
/// assert_eq!(rollout.finals().len(), 1000);
/// assert!(rollout.terminated().iter().all(|&over| over == 0));
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct Environments<T, Sys, A, M, K, S, const O: usize, const D: usize> {
    environment: Environment<A, M, K, S>,
    seed: u64,
    step: u64,
    len: usize,
    execution: Execution,
    /// Pieces of all numbers of [`TILE`] environments each.
    tiles: Buffer<T>,
    counters: Buffer<u32>,
    system: PhantomData<Sys>,
}

/// The memory of neighbouring environments, in whole tiles.
#[derive(Debug)]
pub(super) struct Share<'a, T> {
    pub(super) first: usize,
    pub(super) len: usize,
    /// For each tile rows of [`TILE`]: `D` positions, `D` velocities, and what the episode has paid so far.
    pub(super) tiles: &'a mut [T],
    /// For each tile two rows: steps of the episode, and its number.
    pub(super) counters: &'a mut [u32],
}

impl<T, Sys, A, M, K, S, const O: usize, const D: usize> Environments<T, Sys, A, M, K, S, O, D>
where
    T: Float + Pod,
    A: Assign<Sys>,
    M: Integrator,
    K: Task<T, D, O>,
    S: Start<T, D>,
    Sys: System<T, D> + Copy + Send + Sync,
{
    /// Rows of numbers of a tile.
    const ROWS: usize = 2 * D + 1;

    /// `len` environments, each at the start of its first episode, drawn from `seed`.
    ///
    /// # Errors
    /// [`EnsembleError::TimeStep`] if `dt` is not above zero; [`EnsembleError::Substeps`] if there are none;
    /// [`EnsembleError::Length`] if there are more or fewer systems than environments; [`EnsembleError::Control`] if a number
    /// of the start cannot be; [`EnsembleError::Memory`].
    pub fn new(
        environment: Environment<A, M, K, S>,
        len: usize,
        seed: u64,
        execution: Execution,
    ) -> Result<Self, EnsembleError> {
        let dt = environment.dt;
        if !(dt > 0.0 && T::from_f64(dt) > T::zero() && T::from_f64(dt).is_finite()) {
            return Err(EnsembleError::TimeStep { dt });
        }
        if environment.substeps == 0 {
            return Err(EnsembleError::Substeps);
        }
        environment.start.check()?;
        if let Some(values) = environment.systems.count().filter(|&values| values != len) {
            return Err(EnsembleError::Length { what: "systems", values, len });
        }
        let padded = len.next_multiple_of(TILE);
        let tiles = Buffer::new(padded * Self::ROWS, Pages::Huge)?;
        let counters = Buffer::new(padded * 2, Pages::Huge)?;
        let (step, system) = (0, PhantomData);
        let mut all =
            Environments { environment, seed, step, len, execution, tiles, counters, system };
        for n in 0..len {
            let state = all.environment.start.draw(seed, n as u64, 0);
            all.set(n, &state);
        }
        Ok(all)
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Actions of each so far.
    pub fn step(&self) -> u64 {
        self.step
    }

    /// The state of environment `n`, if there is one.
    pub fn state(&self, n: usize) -> Option<State<T, D>> {
        let number = |row| self.tiles[Self::place(n, row)];
        (n < self.len).then(|| State {
            q: core::array::from_fn(&number),
            v: core::array::from_fn(|i| number(D + i)),
        })
    }

    /// What is seen of environment `n` now, if there is one.
    pub fn observation(&self, n: usize) -> Option<[T; O]> {
        self.state(n).map(|state| self.environment.task.observe(&state))
    }

    /// Fills `rollout` with what all do under `policy`.
    ///
    /// # Errors
    /// [`EnsembleError::Length`] if it is for another number of environments; [`EnsembleError::Truncated`] if it has no room to say that an
    /// episode was cut off, and this can be.
    pub fn rollout<P: Policy<T, O, D>>(
        &mut self,
        policy: P,
        rollout: &mut Rollout<T, O, D>,
    ) -> Result<(), EnsembleError> {
        let (values, len) = (rollout.environments(), self.len);
        if values != len {
            return Err(EnsembleError::Length { what: "environments of the rollout", values, len });
        }
        if self.environment.limit.is_some() && !rollout.has_truncated() {
            return Err(EnsembleError::Truncated);
        }
        let horizon = rollout.horizon();
        let steps = (len as u64).saturating_mul(horizon as u64);
        // A transition writes as much as several steps take.
        let threads = self.execution.threads_for(steps.saturating_mul(WRITTEN));
        let tiles = len.div_ceil(TILE);
        let counts: Vec<usize> = (0..threads)
            .map(|i| [i, i + 1].map(|i| (tiles * i / threads * TILE).min(len)))
            .map(|[from, to]| to - from)
            .collect();
        let (layout, writes) = (rollout.layout(), rollout.writes());
        let rows = rollout.shares(&counts);
        let (mut numbers, mut counters) = (&mut self.tiles[..], &mut self.counters[..]);
        let mut first = 0;
        let mut parts = Vec::with_capacity(counts.len());
        for (len, rows) in counts.into_iter().zip(rows) {
            let padded = len.next_multiple_of(TILE);
            let (own, rest) = numbers.split_at_mut(padded * Self::ROWS);
            numbers = rest;
            let (counts, rest) = counters.split_at_mut(padded * 2);
            counters = rest;
            parts.push((Share { first, len, tiles: own, counters: counts }, rows));
            first += len;
        }
        let (environment, seed, step) = (&self.environment, self.seed, self.step);
        let instructions = self.execution.instruction_set();
        let finals = self.execution.each(parts, |(share, rows)| {
            let system = PhantomData::<Sys>;
            instructions.run(Horizon {
                environment,
                policy,
                seed,
                step,
                share,
                rows,
                layout,
                writes,
                system,
            })
        });
        rollout.finals = finals.into_iter().flatten().collect();
        rollout.finals.sort_by_key(|end| (end.step, end.environment));
        self.step += horizon as u64;
        Ok(())
    }

    /// Where number `row` of environment `n` lies.
    fn place(n: usize, row: usize) -> usize {
        (n / TILE * Self::ROWS + row) * TILE + n % TILE
    }

    fn set(&mut self, n: usize, state: &State<T, D>) {
        for i in 0..D {
            self.tiles[Self::place(n, i)] = state.q[i];
            self.tiles[Self::place(n, D + i)] = state.v[i];
        }
    }
}

/// The shortest steps that take as long as to write a transition.
const WRITTEN: u64 = 4;
