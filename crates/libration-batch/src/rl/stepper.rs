//! The parts of a step of a block: scalar functions in loops over lanes.

use libration_core::control::{Clock, Memory};
use libration_core::random::{Purpose, Streams};
use libration_core::system::CommandedSystem;
use libration_core::{Float, Integrator, State};

use super::block::{BlockOf, LOST, NumberLanes};
use super::block_output::{BlockOutput, Step};
use super::block_size::LANES;
use super::deviation::scale_deviation;
use super::episode_streams::begin_epochs;
use super::history::History;
use super::lanes::Lanes;
use super::{Autoreset, Parts, Policy, Sensor, StepIndex, Task, Variation, World, block};
use crate::ensemble::Assign;
use crate::ensemble::instructions::Target;
use crate::ensemble::kernel::{Lines, at, put};

/// Values that all blocks and steps share.
#[derive(Clone, Copy)]
pub(super) struct Stepper<'s, T, E, P, const O: usize, const D: usize> {
    pub(super) world: &'s E,
    pub(super) policy: P,
    pub(super) history: History,
    pub(super) dt: T,
    /// The time from action to action, in seconds.
    span: f64,
    /// The largest command.
    pub(super) saturation: T,
    /// Acceleration per unit of command: `1/mass`.
    pub(super) mobility: T,
    pub(super) substeps: u64,
    limit: Option<u64>,
    pub(super) autoreset: Autoreset,
}

/// The indices and systems of a block in a step.
pub(super) struct Site<T: Float, E: World<T, O, D>, const O: usize, const D: usize> {
    /// The index of the first lane.
    pub(super) place: StepIndex,
    /// Lanes that are environments.
    pub(super) count: usize,
    pub(super) systems: Systems<T, E, O, D>,
}

/// The systems of the lanes of a block.
type Systems<T, E, const O: usize, const D: usize> =
    <<E as World<T, O, D>>::Systems as Assign<<E as World<T, O, D>>::System>>::Lanes<LANES>;

impl<'s, T, E, P, const O: usize, const D: usize> Stepper<'s, T, E, P, O, D>
where
    T: Float,
    E: World<T, O, D>,
    P: Policy<T, O, D>,
{
    /// Whether the loop over lanes dispatches over integrators at run time.
    const DISPATCHES: bool = E::Method::DISPATCHES && E::Systems::UNIFORM && E::Variation::SAME;

    pub(super) fn new(world: &'s E, policy: P, history: History) -> Self {
        let parts = world.parts();
        Stepper {
            world,
            policy,
            history,
            dt: T::from_f64(parts.dt),
            span: parts.dt * f64::from(parts.substeps),
            saturation: T::from_f64(parts.saturation),
            mobility: T::from_f64(parts.mass.recip()),
            substeps: parts.substeps.into(),
            limit: parts.limit.map(u64::from),
            autoreset: parts.autoreset,
        }
    }

    /// The time since the episode began, in seconds of an ideal clock; 0 if the task does not depend on time.
    #[inline(always)]
    pub(super) fn time(&self, now: u64, began: u64) -> T {
        if const { E::Task::TIMED } {
            // As many as an episode has: a `u32`, of which processors make floats sooner than of a `u64`.
            // Short floats hold no large numbers of steps.
            T::from_f64(f64::from((now - began) as u32) * self.span)
        } else {
            T::zero()
        }
    }

    /// A copy of the environment: behind a reference the compiler would reload it after every store.
    #[inline(always)]
    pub(super) fn parts(&self) -> Parts<T, E, O, D> {
        *self.world.parts()
    }

    /// Computes the observations at the beginning of a step.
    #[inline(always)]
    pub(super) fn observe(
        &self,
        site: &Site<T, E, O, D>,
        block: &BlockOf<T, E, O, D>,
        past: &mut [T],
        words: &mut Streams<LANES>,
        seen: &mut [[T; LANES]; O],
    ) {
        if const { E::Sensor::DRAWS } {
            begin_epochs(words, block, [site.place.step, 1, 0], Purpose::Observation);
        }
        let (mut q, mut v) = (Lines(block.q), Lines(block.v));
        self.pass(site.place.step, block, past);
        if self.history.delays_observations() {
            let step = site.place.step * self.substeps;
            self.history.seen(past, step, &block.delays[0], &mut q.0, &mut v.0);
        }
        let parts = self.parts();
        for l in 0..LANES {
            let (_, task) = lane::<T, E, O, D>(&parts, &site.systems, &block.numbers, l);
            let time = self.time(site.place.step, block.began[l]);
            let sees = task.observe(time, &State { q: at(&q.0, l), v: at(&v.0, l) });
            let mut measured = parts.sensor.measure(sees, &mut || words.next(l));
            if const { E::Sensor::DRAWS } {
                for i in 0..O {
                    measured[i] = scale_deviation(measured[i], sees[i], block.error_scale[1][l]);
                }
            }
            put(seen, l, measured);
        }
    }

    /// Stores states for delayed observations.
    #[inline(always)]
    pub(super) fn pass(&self, now: u64, block: &BlockOf<T, E, O, D>, past: &mut [T]) {
        if self.history.delays_observations() {
            self.history.pass(past, now * self.substeps, &block.q, &block.v);
        }
    }

    /// Computes the actions.
    #[inline(always)]
    pub(super) fn act(
        &self,
        place: StepIndex,
        block: &BlockOf<T, E, O, D>,
        words: &mut Streams<LANES>,
        out: &mut Step<T, O, D>,
    ) {
        if const { P::DRAWS } {
            begin_epochs(words, block, [place.step, 1, 0], Purpose::Action);
        }
        let Step { seen, actions, log_probabilities, .. } = out;
        let policy = self.policy;
        policy.act_all(place, seen, words, actions, log_probabilities);
    }

    /// Advances the states and computes rewards and terminations.
    #[inline(always)]
    pub(super) fn advance<I: Target>(
        &self,
        target: I,
        site: &Site<T, E, O, D>,
        block: &mut BlockOf<T, E, O, D>,
        past: &mut [T],
        words: &mut Streams<LANES>,
        out: &mut BlockOutput<T, O, D>,
    ) -> u8 {
        let (parts, dt) = (self.parts(), self.dt);
        let (mut q, mut v) = (Lines(block.q), Lines(block.v));
        let commands = Lines(self.commands(&out.step.actions));
        let mut held = Lines(self.accelerations(&commands.0));
        if self.history.delays_actions() {
            self.history.act(past, site.place.step, &held.0);
        }
        for substep in 0..self.substeps {
            let step = site.place.step * self.substeps + substep;
            if self.history.delays_actions() {
                let late = &block.delays[1];
                self.history.effective(past, site.place.step, substep, late, &mut held.0);
            }
            if substep > 0 && self.history.delays_observations() {
                self.history.pass(past, step, &q.0, &v.0);
            }
            if const { E::Clock::DRAWS } {
                let now = [site.place.step, self.substeps, substep];
                begin_epochs(words, block, now, Purpose::StepTime);
            }
            let beat = parts.clock.beat(step);
            if const { Self::DISPATCHES } {
                let dt = self.lengths(block, beat, words);
                let (system, _) = lane::<T, E, O, D>(&parts, &site.systems, &block.numbers, 0);
                let lanes = Lanes { q: &mut q.0, v: &mut v.0, held: &held.0, dt: &dt.0 };
                lanes.step(target, system, parts.method);
                continue;
            }
            for l in 0..LANES {
                let (system, _) = lane::<T, E, O, D>(&parts, &site.systems, &block.numbers, l);
                let dt = dt * self.ratio(block, l, beat, words);
                let system = CommandedSystem { system, command: at(&held.0, l) };
                let state = State { q: at(&q.0, l), v: at(&v.0, l) };
                let state = parts.method.step(&system, state, dt);
                put(&mut q.0, l, state.q);
                put(&mut v.0, l, state.v);
            }
        }
        let mut ended = 0;
        for l in 0..LANES {
            let (_, task) = lane::<T, E, O, D>(&parts, &site.systems, &block.numbers, l);
            let after = State { q: at(&q.0, l), v: at(&v.0, l) };
            let action = at(&commands.0, l);
            let acted = is_number(&at(&out.step.actions, l));
            let time = self.time(site.place.step + 1, block.began[l]);
            let (reward, over) = evaluate(&task, acted, time, &block.state(l), &action, &after);
            out.step.rewards[l] = reward;
            block.paid[l] = block.paid[l] + reward;
            out.overs[l] = over;
            ended |= over;
        }
        (block.q, block.v) = (q.0, v.0);
        ended
    }

    /// Flags the episodes that the time limit truncates. Returns early if none can be.
    #[inline(always)]
    pub(super) fn limit(
        &self,
        now: u64,
        block: &BlockOf<T, E, O, D>,
        asked: bool,
        cuts: &mut [u8; LANES],
    ) -> u8 {
        let Some(last) = self.limit.map(|limit| limit - 1) else { return 0 };
        if !asked && now - block.oldest < last {
            return 0;
        }
        let mut ended = 0;
        for (cut, began) in cuts.iter_mut().zip(&block.began) {
            *cut = u8::from(now - began >= last);
            ended |= *cut;
        }
        ended
    }
}

/// The system and the task of lane `l`.
#[inline(always)]
pub(super) fn lane<T: Float, E: World<T, O, D>, const O: usize, const D: usize>(
    parts: &Parts<T, E, O, D>,
    systems: &Systems<T, E, O, D>,
    numbers: &NumberLanes<T, E, O, D>,
    l: usize,
) -> (E::System, E::Task) {
    let numbers = block::Numbers::<T, E, O, D>::lane(numbers, l);
    parts.variation.apply(&numbers, E::Systems::lane(systems, l), parts.task)
}

/// The reward of a step and its termination flags. A step that is not finite is [`LOST`] and has reward 0: a number that is not
/// finite times zero is not zero. `acted` is whether the action was finite.
#[inline(always)]
pub(super) fn evaluate<T: Float, K: Task<T, D, O>, const O: usize, const D: usize>(
    task: &K,
    acted: bool,
    time: T,
    before: &State<T, D>,
    action: &[T; D],
    after: &State<T, D>,
) -> (T, u8) {
    let reward = task.reward(time, before, action, after);
    let mut none = reward * T::zero();
    for i in 0..D {
        none = none + (after.q[i] * T::zero() + after.v[i] * T::zero());
    }
    let lost = !acted | (none != T::zero());
    let over = u8::from(task.terminated(time, after)) | (u8::from(lost) * LOST);
    (if lost { T::zero() } else { reward }, over)
}

/// Whether all components are finite.
#[inline(always)]
fn is_number<T: Float, const D: usize>(action: &[T; D]) -> bool {
    let mut sum = T::zero();
    for &number in action {
        sum = sum + number * T::zero();
    }
    sum == T::zero()
}
