//! The replay buffer.

use bytemuck::Pod;
use libration_core::Float;
use memmap2::MmapMut;

use super::divisor::Divisor;
use super::memory::{Marks, Memory};
use super::sum_tree::Sums;
use super::{Capacity, ReplayError};

/// The episode was over after the transition: terminated.
pub(super) const TERMINATED: u8 = 1;
/// Flag of a truncated episode.
pub(super) const TRUNCATED: u8 = 2;
/// Flag of a transition whose next observation is stored with the ends.
pub(super) const END: u8 = 4;
/// No transition: the environment stood still, or was lost.
pub(super) const NONE: u8 = 8;

/// The last transitions of many environments.
///
/// A transition has a number, which rises with every one that is inserted, and by which a priority is changed: `step · environments +
/// environment`, where steps count from the first one ever inserted.
///
/// ```
/// use libration::State;
/// use libration::ensemble::{All, Execution};
/// use libration::integrator::VelocityVerlet;
/// use libration::replay::{Batch, Capacity, Draw, Lookahead, ReplayBuffer};
/// use libration::rl::policy::Random;
/// use libration::rl::{Environment, Environments, Plan, Rollout};
/// use libration::rl::{start::FixedStart, task::Regulate};
/// use libration::system::Oscillator;
///
/// # fn main() -> Result<(), libration::replay::ReplayError> {
/// let spring = All(Oscillator { omega2: 10.0_f32 });
/// let task = Regulate { position: 1.0, velocity: 0.1, effort: 0.0, bound: 10.0 };
/// let start = FixedStart(State { q: [1.0], v: [0.0] });
/// let environment = Environment::new(spring, VelocityVerlet, 0.01, task, start).limit(200);
/// let mut all = Environments::new(environment, 64, 7, Execution::serial())?;
/// let mut rollout = Rollout::new(Plan::new(100, 64).truncated())?;
///
/// let mut replay = ReplayBuffer::<f32>::new([2, 1], Capacity::new(10_000, 64))?;
/// let mut next = vec![0.0; 64 * 2];
/// for _ in 0..5 {
///     all.rollout(Random::between([-1.0], [1.0]), &mut rollout)?;
///     all.observe(&mut next)?;
///     replay.insert(&rollout, &next, &Execution::serial())?;
/// }
/// let mut batch = Batch::new(256, replay.sizes());
/// let draw = Draw { seed: 7, number: 0 };
/// replay.sample(draw, Lookahead::default(), &mut batch.columns(), &Execution::serial())?;
/// assert!(batch.number.iter().all(|&number| replay.contains(number)));
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct ReplayBuffer<T> {
    /// Numbers of observations and actions.
    pub(super) sizes: [usize; 2],
    pub(super) capacity: Capacity,
    /// Environments, and rows.
    pub(super) width: Divisor,
    height: Divisor,
    pub(super) memory: Memory,
    pub(super) marks: Marks,
    /// The weights; empty without priorities.
    pub(super) sums: Option<Sums>,
    number: core::marker::PhantomData<T>,
}

impl<T: Float + Pod> ReplayBuffer<T> {
    /// An empty buffer in new memory, of transitions with these numbers of observations and actions, each at least 1.
    ///
    /// # Errors
    /// [`ReplayError::Nothing`] if a size or the capacity is 0; [`ReplayError::Environment`] if there is not so much memory.
    pub fn new(sizes: [usize; 2], capacity: Capacity) -> Result<Self, ReplayError> {
        let memory = Memory::anonymous::<T>(&capacity, sizes)?;
        Ok(Self::empty(sizes, capacity, memory))
    }

    /// An empty one in memory that is all zeros, as that of a new file: of at least [`Capacity::bytes`].
    ///
    /// # Errors
    /// As [`new`](Self::new), and [`ReplayError::Capacity`] if the memory is too short.
    pub fn create(
        map: MmapMut,
        sizes: [usize; 2],
        capacity: Capacity,
    ) -> Result<Self, ReplayError> {
        let memory = Memory::create::<T>(map, &capacity, sizes)?;
        Ok(Self::empty(sizes, capacity, memory))
    }

    fn empty(sizes: [usize; 2], capacity: Capacity, memory: Memory) -> Self {
        let cells = capacity.rows() * capacity.environments;
        let sums = capacity.priorities.then(|| Sums::zero(cells));
        ReplayBuffer { sums, ..Self::of(sizes, capacity, memory, Marks::NONE) }
    }

    /// One without sums.
    fn of(sizes: [usize; 2], capacity: Capacity, memory: Memory, marks: Marks) -> Self {
        ReplayBuffer {
            sizes,
            capacity,
            width: Divisor::new(capacity.environments),
            height: Divisor::new(capacity.rows()),
            memory,
            marks,
            sums: None,
            number: core::marker::PhantomData,
        }
    }

    /// Opens the memory of an earlier buffer: a file or a copy of its [`bytes`](Self::bytes). All completed insertions are kept,
    /// even if the process died during the next one.
    ///
    /// # Errors
    /// [`ReplayError::Other`] if that was none, or one of other numbers; [`ReplayError::Damaged`] if it contradicts itself.
    pub fn open(map: MmapMut, sizes: [usize; 2]) -> Result<Self, ReplayError> {
        let (memory, capacity, marks) = Memory::open::<T>(map, sizes)?;
        let mut replay = Self::of(sizes, capacity, memory, marks);
        replay.verify()?;
        replay.mark_parted();
        if capacity.priorities {
            replay.recompute_weights();
            replay.sums = Some(Sums::over(replay.weights()));
        }
        Ok(replay)
    }

    /// The numbers of observations and actions of a transition.
    pub fn sizes(&self) -> [usize; 2] {
        self.sizes
    }

    /// The capacity.
    pub fn capacity(&self) -> Capacity {
        self.capacity
    }

    /// Transitions that are there, without steps that were none.
    pub fn len(&self) -> u64 {
        self.marks.live
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Steps that are there, of every environment.
    pub fn steps(&self) -> u64 {
        self.marks.head - self.marks.tail
    }

    /// Steps that were ever inserted.
    pub fn inserted(&self) -> u64 {
        self.marks.head
    }

    /// Whether the transition of this number is there.
    pub fn contains(&self, number: u64) -> bool {
        let (step, n) = self.width.divide(number);
        (self.marks.tail..self.marks.head).contains(&step)
            && self.flags()[self.cell(step, n as usize)] & NONE == 0
    }

    /// All of it, as it can be kept and [opened](Self::open) again.
    pub fn bytes(&self) -> &[u8] {
        self.memory.bytes()
    }

    /// The memory map, for a caller that keeps it in a file.
    pub fn map(&self) -> &MmapMut {
        self.memory.map()
    }

    /// The cell of a step of environment `n` in the fields.
    #[inline(always)]
    pub(super) fn cell(&self, step: u64, n: usize) -> usize {
        self.row(step) * self.capacity.environments + n
    }

    /// The cell of the transition of this number.
    #[inline(always)]
    pub(super) fn cell_of(&self, number: u64) -> usize {
        let (step, n) = self.width.divide(number);
        self.cell(step, n as usize)
    }

    /// The row of a step.
    #[inline(always)]
    pub(super) fn row(&self, step: u64) -> usize {
        self.height.divide(step).1 as usize
    }

    /// `[cell, i]`.
    pub(super) fn observation(&self) -> &[T] {
        self.memory.field(&self.memory.fields.observation)
    }

    /// `[cell, i]`.
    pub(super) fn action(&self) -> &[T] {
        self.memory.field(&self.memory.fields.action)
    }

    pub(super) fn reward(&self) -> &[T] {
        self.memory.field(&self.memory.fields.reward)
    }

    pub(super) fn flags(&self) -> &[u8] {
        self.memory.field(&self.memory.fields.flags)
    }

    pub(super) fn weights(&self) -> &[f64] {
        self.memory.field(&self.memory.fields.weight)
    }

    fn end_place(&self) -> &[u64] {
        self.memory.field(&self.memory.fields.end_place)
    }

    /// `[end, i]`.
    fn end_seen(&self) -> &[T] {
        self.memory.field(&self.memory.fields.end_seen)
    }

    /// The [place](Self::place_of) of the transition of end `i`.
    pub(super) fn place(&self, i: u64) -> u64 {
        self.end_place()[(i % self.capacity.ends as u64) as usize]
    }

    /// The step that end `i` belongs to.
    pub(super) fn step_of_end(&self, i: u64) -> u64 {
        self.place(i) / (2 * self.capacity.environments as u64)
    }

    /// Where the end of a transition stands: by its step; then those of episodes, and after them those of what was reset, which are
    /// known later; then by its environment.
    pub(super) fn place_of(&self, step: u64, n: usize, reset: bool) -> u64 {
        (2 * step + u64::from(reset)) * self.capacity.environments as u64 + n as u64
    }

    /// The first end from a place on.
    fn first_from(&self, place: u64) -> u64 {
        let (mut low, mut high) = (self.marks.ends.first, self.marks.ends.end);
        while low < high {
            let middle = low + (high - low) / 2;
            if self.place(middle) < place { low = middle + 1 } else { high = middle }
        }
        low
    }

    /// The observation after a transition with these flags, if it is stored with the ends.
    pub(super) fn end_of(&self, step: u64, n: usize, flags: u8) -> Option<&[T]> {
        if flags & END == 0 {
            return None;
        }
        let place = self.place_of(step, n, flags & (TERMINATED | TRUNCATED) == 0);
        let i = self.first_from(place);
        let width = self.sizes[0];
        let seen = || {
            let at = (i % self.capacity.ends as u64) as usize;
            &self.end_seen()[at * width..][..width]
        };
        (i < self.marks.ends.end && self.place(i) == place).then(seen)
    }

    /// The first end that belongs to a step from `step` on.
    pub(super) fn first_end(&self, step: u64) -> u64 {
        self.first_from(self.place_of(step, 0, false))
    }
}
