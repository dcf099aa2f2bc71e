//! A batch of environments.

use bytemuck::Pod;
use libration_core::control::Clock;
use libration_core::control::error::ensure;
use libration_core::random::Purpose;
use libration_core::{Float, State};

use super::block::{BlockOf, TERMINATED};
use super::block_size::LANES;
use super::episode_streams::EpisodeStreams;
use super::error::NOTHING_DRAWN;
use super::history::History;
use super::start::Episode;
use super::{
    Autoreset, Environment, EnvironmentError, Sensor, Start, Task, Variation, World, block,
};
use crate::ensemble::kernel::at;
use crate::ensemble::{Assign, EnsembleError, Execution, InsufficientMemory};

/// A batch of environments that are stepped together.
///
/// ```
/// use libration::State;
/// use libration::control::clock::{Gaussian, Jittered};
/// use libration::ensemble::{All, Execution};
/// use libration::integrator::SymplecticEuler;
/// use libration::rl::policy::Linear;
/// use libration::rl::{Delays, Environment, Environments, Plan, Rollout};
/// use libration::rl::{start::UniformStart, task::Regulate};
/// use libration::system::Oscillator;
///
/// # fn main() -> Result<(), libration::rl::EnvironmentError> {
/// let spring = All(Oscillator { omega2: 10.0_f32 });
/// let task = Regulate { position: 1.0, velocity: 0.1, effort: 0.0, bound: 10.0 };
/// let start = UniformStart(State { q: [-1.0], v: [0.0] }, State { q: [1.0], v: [0.0] });
/// let environment = Environment::new(spring, SymplecticEuler, 0.01, task, start)
///     .limit(200)
///     .delays(Delays::of(0, 1))
///     .clock(Jittered(Gaussian(0.1)));
/// let mut all = Environments::new(environment, 1000, 7, Execution::serial())?;
/// let policy = Linear { weights: [[-10.0, -2.0]], bias: [0.0] };
/// let mut rollout = Rollout::new(Plan::new(256, 1000).truncated())?;
/// all.rollout(policy, &mut rollout)?;
/// // Every episode was cut off once, and none was lost.
/// assert_eq!(rollout.finals().len(), 1000);
/// assert!(rollout.terminated().iter().all(|&over| over == 0));
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct Environments<T, E, const O: usize, const D: usize>
where
    T: Float,
    E: World<T, O, D>,
{
    pub(super) world: E,
    pub(super) seed: u64,
    pub(super) first: usize,
    pub(super) step: u64,
    pub(super) len: usize,
    pub(super) execution: Execution,
    pub(super) blocks: Vec<BlockOf<T, E, O, D>>,
    pub(super) history: History,
    pub(super) past: Vec<T>,
    /// The random streams of clocks, sensors and actions.
    pub(super) draws: [EpisodeStreams; 3],
}

impl<T, E, const O: usize, const D: usize> Environments<T, E, O, D>
where
    T: Float + Pod,
    E: World<T, O, D>,
{
    /// `len` environments, each at the start of its first episode. `seed` determines all random numbers.
    ///
    /// # Errors
    /// [`EnvironmentError::Ensemble`] if the time step is not above zero, the number of substeps is 0, the number of systems or
    /// rates of clocks is not that of the environments, or the memory is insufficient; [`EnvironmentError::Number`] if a parameter is
    /// invalid; [`EnvironmentError::Limit`].
    pub fn new(
        world: E,
        len: usize,
        seed: u64,
        execution: Execution,
    ) -> Result<Self, EnvironmentError> {
        Environments::shard(world, 0, len, seed, execution)
    }

    /// A shard of a larger batch: the environments from number `first` on. Other processes or machines may run the rest. Each
    /// environment behaves as in the whole batch.
    ///
    /// Systems, actions and weights are listed for the environments of the shard; rates of clocks for all environments up to
    /// its last. Numbers of environments in ends of episodes are relative to `first`.
    ///
    /// # Errors
    /// As for [`new`](Self::new).
    pub fn shard(
        world: E,
        first: usize,
        len: usize,
        seed: u64,
        execution: Execution,
    ) -> Result<Self, EnvironmentError> {
        let parts = world.parts();
        let Environment { dt, substeps, delays, .. } = *parts;
        if !(dt > 0.0 && T::from_f64(dt) > T::zero() && T::from_f64(dt).is_finite()) {
            return Err(EnsembleError::TimeStep { dt }.into());
        }
        if substeps == 0 {
            return Err(EnsembleError::Substeps.into());
        }
        if parts.limit == Some(0) {
            return Err(EnvironmentError::Limit);
        }
        let allowed = "at most 2⁵³";
        ensure("number of the first environment", first as f64, allowed, |n| n <= FURTHEST)?;
        parts.task.check()?;
        parts.start.check()?;
        parts.clock.check()?;
        parts.sensor.check()?;
        parts.variation.check()?;
        delays.check()?;
        let [clock, sensor] = [parts.clock.words(), parts.sensor.words()].map(|n| n as f64);
        let (timed, seen) = (E::Clock::DRAWS, E::Sensor::DRAWS);
        ensure("random words of the clock", clock, NOTHING_DRAWN, |n| timed || n == 0.0)?;
        ensure("random words of the sensor", sensor, NOTHING_DRAWN, |n| seen || n == 0.0)?;
        parts.error_scale.check::<T>()?;
        let most = parts.saturation;
        ensure("saturation", most, "above 0", |most| T::from_f64(most) > T::zero())?;
        let rates = parts.clock.trajectories();
        let allowed = "a finite number above 0 whose inverse is one in the float type";
        ensure("mass", parts.mass, allowed, |mass| {
            let mobility = T::from_f64(mass.recip());
            mobility > T::zero() && mobility.is_finite() && mass.is_finite()
        })?;
        for (what, values, len) in [
            ("systems", parts.systems.count(), len),
            ("rates of clocks", rates, first.saturating_add(len)),
        ] {
            if let Some(values) = values.filter(|&values| values != len) {
                return Err(EnsembleError::Length { what, values, len }.into());
            }
        }
        let history = History::new(delays, substeps, [2 * D, D]);
        let count = len.div_ceil(LANES);
        let blocks = try_fill(count, &block::empty::<T, E, O, D>())?;
        let past = try_fill(count.saturating_mul(history.len()), &T::zero())?;
        let draws =
            [Purpose::StepTime, Purpose::Observation, Purpose::Action].map(EpisodeStreams::new);
        let step = 0;
        let mut all =
            Environments { world, seed, first, step, len, execution, blocks, history, past, draws };
        for n in 0..len {
            all.begin(n, Episode { seed, environment: (first + n) as u64, number: 0 });
        }
        Ok(all)
    }

    /// The number of environments.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether the batch is empty.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The number of actions of each environment so far.
    pub fn step(&self) -> u64 {
        self.step
    }

    /// Sets the execution. Results do not depend on it.
    pub fn execute(&mut self, execution: Execution) {
        self.execution = execution;
    }

    /// The definition of the environments.
    pub fn world(&self) -> &E {
        &self.world
    }

    /// The state of environment `n`; none if `n` is out of range.
    pub fn state(&self, n: usize) -> Option<State<T, D>> {
        (n < self.len).then(|| self.blocks[n / LANES].state(n % LANES))
    }

    /// The address of the episode of environment `n`; none if `n` is out of range.
    pub fn episode(&self, n: usize) -> Option<Episode> {
        (n < self.len).then(|| self.blocks[n / LANES].episode(n % LANES))
    }

    /// Latencies of observations and of actions in steps of the integrator, and the error scales of the clock and of the sensor, of the
    /// episode of environment `n`; none if `n` is out of range.
    pub fn perturbations(&self, n: usize) -> Option<([u32; 2], [T; 2])> {
        let block = (n < self.len).then(|| &self.blocks[n / LANES])?;
        Some((block.delays.map(|row| row[n % LANES]), at(&block.error_scale, n % LANES)))
    }

    /// Puts environment `n` at a state. Its episode goes on from there; what it observes and what acts on it before latencies are over
    /// is that of a beginning.
    ///
    /// # Errors
    /// [`EnvironmentError::Shape`] if there is no such environment.
    pub fn set_state(&mut self, n: usize, state: State<T, D>) -> Result<(), EnvironmentError> {
        EnvironmentError::shape("environments", self.len, self.len.max(n.saturating_add(1)))?;
        let (b, l) = (n / LANES, n % LANES);
        self.blocks[b].put_state(l, state);
        let past = &mut self.past[b * self.history.len()..][..self.history.len()];
        self.history.begin(past, l, state.coordinates());
        Ok(())
    }

    /// Begins a new episode in every environment whose flag is `true`.
    ///
    /// # Errors
    /// [`EnvironmentError::Shape`] if the number of flags is not the number of environments.
    pub fn reset(&mut self, which: &[bool]) -> Result<(), EnvironmentError> {
        EnvironmentError::shape("reset flags", which.len(), self.len)?;
        for n in (0..self.len).filter(|&n| which[n]) {
            let next = self.blocks[n / LANES].next(n % LANES);
            self.begin(n, next);
        }
        Ok(())
    }

    /// Terminates the episode of every environment whose flag is `true`, as if its task had in the step before.
    ///
    /// # Errors
    /// [`EnvironmentError::Shape`] if the number of flags is not the number of environments.
    pub fn end(&mut self, which: &[bool]) -> Result<(), EnvironmentError> {
        EnvironmentError::shape("end flags", which.len(), self.len)?;
        if self.world.parts().autoreset == Autoreset::SameStep {
            return self.reset(which);
        }
        for n in (0..self.len).filter(|&n| which[n]) {
            self.blocks[n / LANES].ended[n % LANES] |= TERMINATED;
        }
        Ok(())
    }

    /// Begins a first episode in every environment with a seed. The environment then equals the only environment of a batch with
    /// that seed.
    ///
    /// # Errors
    /// [`EnvironmentError::Shape`] if the number of seeds is not the number of environments; [`EnvironmentError::Seeded`] if rates of
    /// clocks are listed.
    pub fn seed(&mut self, seeds: &[Option<u64>]) -> Result<(), EnvironmentError> {
        EnvironmentError::shape("seeds", seeds.len(), self.len)?;
        if self.world.parts().clock.trajectories().is_some() {
            return Err(EnvironmentError::Seeded);
        }
        for (n, seed) in seeds.iter().enumerate() {
            if let &Some(seed) = seed {
                self.begin(n, Episode { seed, environment: 0, number: 0 });
            }
        }
        Ok(())
    }

    /// Begins an episode of environment `n`.
    fn begin(&mut self, n: usize, episode: Episode) {
        let Environments { world, history, step, .. } = *self;
        let (b, l) = (n / LANES, n % LANES);
        let past = &mut self.past[b * history.len()..][..history.len()];
        block::begin(&mut self.blocks[b], history, past, &world, l, episode, step);
        self.blocks[b].settle();
    }
}

/// The largest number of a first environment; later numbers then fit as well.
const FURTHEST: f64 = (1_u64 << 53) as f64;

/// A vector of `count` copies of `x`.
///
/// # Errors
/// If the memory is insufficient.
fn try_fill<X: Clone>(count: usize, x: &X) -> Result<Vec<X>, EnsembleError> {
    let mut all = Vec::new();
    let needed = count as u128 * size_of::<X>() as u128;
    InsufficientMemory::check(needed)?;
    let refused = |_| InsufficientMemory { needed, available: None };
    all.try_reserve_exact(count).map_err(refused)?;
    all.resize(count, x.clone());
    Ok(all)
}
