//! Many control loops, each with its clock, its delays and its controller.

mod generators;
mod kernel;
mod lane;
mod rows;
mod run;
mod setup;

use core::marker::PhantomData;
use core::ops::Range;

use bytemuck::Pod;

pub use setup::Setup;

use kernel::Common;
use libration_core::control::error::ensure_finite;
use libration_core::control::{
    Clock, Controller, Delay, Disturbance, Memory, NoDisturbance, StartAddress,
};
use libration_core::{Float, Integrator, State, System};
use rows::Memories;
use run::Run;
use setup::Layout;

use super::{
    Assign, Ensemble, EnsembleError, Execution, GRAIN, NoObserver, Observer, chunk, shares,
};

/// Trajectories of a plant with `D` degrees of freedom under control.
///
/// The bits of a trajectory depend on its number, its start, the setup and the seed. They do not depend on the number of
/// trajectories or threads, or on the number of steps per call.
///
/// ```
/// use libration::State;
/// use libration::control::{Feedback, Latency, Schedule};
/// use libration::control::clock::{Gaussian, Jittered};
/// use libration::control::controller::StateFeedback;
/// use libration::ensemble::{All, Execution, Loops, Setup};
/// use libration::integrator::VelocityVerlet;
/// use libration::system::Oscillator;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let gains = Feedback { position: 10.0, velocity: 2.0 };
/// let latency = Latency::of_steps(1.5).ok_or("no latency")?;
/// let setup = Setup::new(All(Oscillator { omega2: 10.0 }), VelocityVerlet)
///     .controller(StateFeedback::to_origin(gains))
///     .clock(Jittered(Gaussian(0.1)))
///     .delay(Schedule::late(latency));
/// let starts = [State { q: [1.0_f64], v: [0.0] }; 100];
/// let (dt, seed, before) = (0.01, 7, [0.0]);
/// let mut loops = Loops::new(setup, dt, seed, before, &starts, Execution::serial())?;
/// loops.advance(1000)?;
/// // Ten seconds of a loop that is damped.
/// assert!(loops.trajectories().q(0).iter().all(|q| q.abs() < 0.01));
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct Loops<T, Sys, A, M, K, C, L, const D: usize, N = NoDisturbance> {
    setup: Setup<A, M, K, C, L, N>,
    layout: Layout,
    dt: T,
    seed: u64,
    before: [T; D],
    trajectories: Ensemble<T, D>,
    memories: Memories<T>,
    system: PhantomData<Sys>,
}

impl<T, Sys, A, M, K, C, L, const D: usize, N> Loops<T, Sys, A, M, K, C, L, D, N>
where
    T: Float + Pod,
    A: Assign<Sys>,
    M: Integrator,
    K: Controller<T, D>,
    C: Clock<T>,
    L: Delay<T>,
    N: Disturbance,
    Sys: System<T, D> + Copy + Send + Sync,
{
    /// Loops in steps of `dt` seconds that start from `states`; all that is random is drawn from `seed`. Until a first command
    /// arrives, `before` acts.
    ///
    /// # Errors
    /// [`EnsembleError::TimeStep`] if `dt` is not above zero; [`EnsembleError::Length`] if there are more or fewer
    /// systems, rates or latencies than trajectories; [`EnsembleError::Control`] if a number of the setup, or `before`, cannot
    /// be; [`EnsembleError::Memory`].
    pub fn new(
        setup: Setup<A, M, K, C, L, N>,
        dt: T,
        seed: u64,
        before: [T; D],
        states: &[State<T, D>],
        execution: Execution,
    ) -> Result<Self, EnsembleError> {
        if !(dt > T::zero() && dt.is_finite()) {
            return Err(EnsembleError::TimeStep { dt: dt.to_f64() });
        }
        setup.clock.check()?;
        setup.delay.check()?;
        setup.disturbance.check::<T>()?;
        let period = dt.to_f64() * setup.delay.schedule().period();
        setup.controller.check(period)?;
        before
            .iter()
            .try_for_each(|x| ensure_finite::<T>("the command before the first", x.to_f64()))?;
        let len = states.len();
        for (what, values) in [
            ("systems", setup.systems.count()),
            ("rates of clocks", setup.clock.trajectories()),
            ("latencies", setup.delay.trajectories()),
        ] {
            if let Some(values) = values.filter(|&values| values != len) {
                return Err(EnsembleError::Length { what, values, len });
            }
        }
        let layout = Layout::of::<T, A, M, K, C, L, N, D>(&setup);
        let trajectories = Ensemble::new(states, execution)?;
        let memories = Memories::new(len, layout.rows)?;
        let system = PhantomData;
        let mut loops = Loops { setup, layout, dt, seed, before, trajectories, memories, system };
        (0..len).for_each(|n| loops.forget(n));
        Ok(loops)
    }

    /// Number of trajectories.
    pub fn len(&self) -> usize {
        self.trajectories.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.trajectories.is_empty()
    }

    /// Number of steps taken.
    pub fn step(&self) -> u64 {
        self.trajectories.step
    }

    /// The states.
    pub fn trajectories(&self) -> &Ensemble<T, D> {
        &self.trajectories
    }

    /// Trajectory `n`, if there is one.
    pub fn state(&self, n: usize) -> Option<State<T, D>> {
        self.trajectories.state(n)
    }

    /// The command that acts on trajectory `n`, if there is such a trajectory; without a controller there is none.
    pub fn command(&self, n: usize) -> Option<[T; D]> {
        let place = |row| self.memories.numbers()[self.place(n, row)];
        (K::ACTS && n < self.len()).then(|| core::array::from_fn(|i| place(self.layout.held + i)))
    }

    /// Takes `steps` steps with every trajectory.
    ///
    /// # Errors
    /// [`EnsembleError::Record`] if a recorded clock or delay ends before.
    pub fn advance(&mut self, steps: u64) -> Result<(), EnsembleError> {
        self.run(steps, GRAIN, |_| None::<(u64, NoObserver)>).map(|_| ())
    }

    /// [`Loops::advance`] under the eyes of observers, as [`Ensemble::observe`] has them.
    ///
    /// # Errors
    /// As for `advance`; [`EnsembleError::Every`] if `every` is 0.
    pub fn observe<O: Observer<T, D>>(
        &mut self,
        steps: u64,
        every: u64,
        observer: impl Fn(Range<usize>) -> O + Sync,
    ) -> Result<Vec<O>, EnsembleError> {
        if every == 0 {
            return Err(EnsembleError::Every);
        }
        let chunk = chunk(self.len());
        self.run(steps, chunk, |range| Some((every, observer(range))))
    }

    fn run<O: Observer<T, D>>(
        &mut self,
        steps: u64,
        grain: usize,
        observer: impl Fn(Range<usize>) -> Option<(u64, O)> + Sync,
    ) -> Result<Vec<O>, EnsembleError> {
        let range = self.step()..self.step().saturating_add(steps);
        let setup = &self.setup;
        for known in [setup.clock.steps(), setup.delay.steps()].into_iter().flatten() {
            if range.end > known {
                return Err(EnsembleError::Record { known, requested: range.end });
            }
        }
        let common = Common { setup, layout: self.layout, dt: self.dt, seed: self.seed };
        let execution = self.trajectories.execution.clone();
        let count = self.trajectories.threads_for::<M, Sys>(setup.method, steps);
        let mut rows = self.memories.rows();
        let shares = shares(self.trajectories.planes.share(), count, grain);
        let parts = shares.into_iter().map(|share| {
            let rows = rows.split_off(share.len().next_multiple_of(GRAIN));
            (share, rows)
        });
        let observed = execution.each(parts.collect(), |(mut share, mut rows)| {
            let mut observers = Vec::new();
            while share.len() > 0 {
                // Where nobody watches, all at once.
                let size = if O::WATCHES { grain } else { share.len() };
                let share = share.split_off(size);
                let rows = rows.split_off(size.next_multiple_of(GRAIN));
                let mut sees = observer(share.first..share.first + share.len());
                let watch = sees.as_mut().map(|(every, observer)| (*every, observer));
                let steps = range.clone();
                let run =
                    Run { common: &common, share, rows, steps, watch, system: PhantomData::<Sys> };
                execution.instruction_set().run(run);
                observers.extend(sees.map(|(_, observer)| observer));
            }
            observers
        });
        self.trajectories.step = range.end;
        Ok(observed.into_iter().flatten().collect())
    }

    /// Puts trajectory `n`, if there is one, back to `state`, as if it began there: what was remembered and what was on its way
    /// is forgotten. Steps are counted on, so that its noise, what is drawn once for a
    /// trajectory, and a clock that depends on the step, are those of the step at which all are.
    pub fn reset(&mut self, n: usize, state: State<T, D>) {
        if n < self.len() {
            self.trajectories.planes.share().set(n, state);
            self.forget(n);
        }
    }

    /// All that loops remember, as it lies in memory.
    pub(super) fn memories(&self) -> &[T] {
        self.memories.numbers()
    }

    /// All that changes.
    pub(super) fn state_mut(&mut self) -> (&mut Ensemble<T, D>, &mut [T]) {
        (&mut self.trajectories, self.memories.numbers_mut())
    }

    /// The seed of all random numbers.
    pub(super) fn seed(&self) -> u64 {
        self.seed
    }

    /// The time step in seconds.
    pub(super) fn dt(&self) -> T {
        self.dt
    }

    /// The index of number `row` of trajectory `n`.
    fn place(&self, n: usize, row: usize) -> usize {
        (n / GRAIN * self.layout.rows + row) * GRAIN + n % GRAIN
    }

    /// Sets what trajectory `n` remembers to what it is before the first step.
    fn forget(&mut self, n: usize) {
        let Some(state) = self.state(n) else { return };
        let Layout { clock, delay, controller, held, rows, .. } = self.layout;
        let (setup, begin) = (&self.setup, StartAddress::new(self.seed, n as u64, self.step()));
        // One lane.
        let clocks = setup.clock.start(begin).single_lane();
        let delays = setup.delay.start(begin).single_lane();
        let controllers = setup.controller.start(&state).single_lane();
        let mut values = Vec::with_capacity(rows);
        let mut push = |_: usize, &[value]: &[T; 1]| values.push(value);
        C::Memory::store(&clocks, &mut push);
        L::Memory::store(&delays, &mut push);
        K::Memory::store(&controllers, &mut push);
        debug_assert_eq!([clock, delay, controller + K::Memory::LEN], [0, C::Memory::LEN, held]);
        // What acts, and all that would arrive.
        values.extend(self.before.iter().cycle().take(rows - held));
        for (row, value) in values.into_iter().enumerate() {
            let place = self.place(n, row);
            self.memories.numbers_mut()[place] = value;
        }
    }
}
