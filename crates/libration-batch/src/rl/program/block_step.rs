//! The parts of a step of a block.

use libration_core::control::clock::Noise;
use libration_core::control::{Clock, Memory};
use libration_core::random::{Purpose, Streams};

use super::ProgramPolicy;
use super::block_state::{BlockState, Row, row_of, set_times};
use super::command_limits::CommandLimits;
use super::environment::World;
use super::episodes::EpisodeBlock;
use super::row_program::ProgramRows;
use super::state::Programs;
use crate::ensemble::{BatchFloat, InstructionSet};
use crate::rl::block::{ClockMemory, LOST};
use crate::rl::block_size::LANES;
use crate::rl::deviation::scale_deviation;
use crate::rl::episode_streams::begin_epochs;
use crate::rl::history::History;
use crate::rl::{ProgramEnvironment, StepIndex};

/// What all blocks and steps of a thread share, with the rows that a step fills.
pub(super) struct BlockStep<'s, T> {
    pub(super) definition: &'s ProgramEnvironment,
    pub(super) history: History,
    world: World,
    instructions: InstructionSet,
    /// The length of a step of the integrator without jitter.
    dt: T,
    /// The time from action to action, in seconds.
    span: f64,
    limits: CommandLimits<T>,
    /// Whether observation and verdict depend on time.
    is_timed: [bool; 2],
    step: ProgramRows<'s, T>,
    projection: Option<ProgramRows<'s, T>>,
    inner: Option<ProgramRows<'s, T>>,
    observation: ProgramRows<'s, T>,
    verdict: ProgramRows<'s, T>,
    pub(super) seen: Vec<Row<T>>,
    /// The observations after a step with which an episode ended.
    pub(super) last: Vec<Row<T>>,
    pub(super) actions: Vec<Row<T>>,
    pub(super) log_probabilities: Row<T>,
    pub(super) rewards: Row<T>,
    pub(super) overs: [u8; LANES],
    commands: Vec<Row<T>>,
    held: Vec<Row<T>>,
    /// The commands of the inner controller.
    inner_commands: Vec<Row<T>>,
    /// Positions and velocities at other times than now.
    other: Vec<Row<T>>,
    /// Positions and velocities before a step of the integrator, for its projection.
    previous: Vec<Row<T>>,
    lengths: Row<T>,
    times: Row<T>,
    judged: [Row<T>; 2],
}

impl<'s, T: BatchFloat> BlockStep<'s, T> {
    pub(super) fn new(
        definition: &'s ProgramEnvironment,
        programs: &'s Programs,
        history: History,
        instructions: InstructionSet,
        environments: usize,
    ) -> Self {
        let zeros = [T::zero(); LANES];
        let rows = |count: usize| vec![zeros; count];
        let lanes = environments.min(LANES);
        let dt = T::from_f64(definition.dt);
        let (actions, coordinates) = (definition.actions(), definition.coordinates());
        let projection = programs.projection.as_ref();
        BlockStep {
            definition,
            history,
            world: definition.world(),
            instructions,
            dt,
            span: definition.period(),
            limits: CommandLimits::new(definition),
            is_timed: programs.is_timed(),
            step: programs.step.rows(lanes, dt),
            projection: projection.map(|program| program.rows(lanes, dt)),
            inner: programs.inner.as_ref().map(|program| program.rows(lanes, T::zero())),
            observation: programs.observation.rows(lanes, T::zero()),
            verdict: programs.verdict.rows(lanes, T::zero()),
            seen: rows(definition.observations()),
            last: rows(definition.observations()),
            actions: rows(actions),
            log_probabilities: zeros,
            rewards: zeros,
            overs: [0; LANES],
            commands: rows(actions),
            held: rows(actions),
            inner_commands: rows(
                definition.task.inner.as_ref().map_or(0, |all| all.outputs().len()),
            ),
            other: rows(coordinates),
            previous: rows(projection.map_or(0, |_| coordinates)),
            lengths: [dt; LANES],
            times: zeros,
            judged: [zeros; 2],
        }
    }

    fn substeps(&self) -> u64 {
        self.definition.substeps.into()
    }

    /// Computes the observations at the beginning of step `now`.
    pub(super) fn observe(
        &mut self,
        now: u64,
        block: &mut BlockState<'_, T>,
        words: &mut Streams<LANES>,
    ) {
        let noisy = self.definition.is_noisy();
        if noisy {
            begin_epochs(words, block.episodes, [now, 1, 0], Purpose::Observation);
        }
        self.pass(now, block);
        let mut states = &*block.states;
        if self.history.delays_observations() {
            let (q, v) = self.other.split_at_mut(states.len() / 2);
            let late = &block.episodes.delays[0];
            self.history.seen(block.past, now * u64::from(self.definition.substeps), late, q, v);
            states = &self.other;
        }
        if self.is_timed[0] {
            set_times(&mut self.times, now, &block.episodes.began, self.span);
        }
        let parameters = &block.numbers[..self.definition.parameters.len()];
        let rows = [states, parameters];
        let input = |i: usize| row_of(rows, i).unwrap_or(&self.times);
        self.observation.run(input, &mut self.seen, self.instructions);
        if !noisy {
            return;
        }
        let scale = &block.episodes.error_scale[1];
        for (row, noise) in self.seen.iter_mut().zip(&self.definition.noise) {
            for (l, x) in row.iter_mut().enumerate() {
                let measured = *x + noise.draw(&mut || words.next(l));
                *x = scale_deviation(measured, *x, scale[l]);
            }
        }
    }

    /// Stores states for delayed observations.
    pub(super) fn pass(&self, now: u64, block: &mut BlockState<'_, T>) {
        if self.history.delays_observations() {
            let (q, v) = block.states.split_at(block.states.len() / 2);
            self.history.pass(block.past, now * self.substeps(), q, v);
        }
    }

    /// Computes the actions.
    pub(super) fn act(
        &mut self,
        policy: &ProgramPolicy<'_, T>,
        place: StepIndex,
        block: &BlockState<'_, T>,
        words: &mut Streams<LANES>,
    ) {
        if policy.words() > 0 {
            begin_epochs(words, block.episodes, [place.step, 1, 0], Purpose::Action);
        }
        policy.act(place, &self.seen, words, &mut self.actions, &mut self.log_probabilities);
    }

    /// Advances the states and computes rewards and terminations. Returns whether an episode of the first `count` lanes ended.
    pub(super) fn advance(
        &mut self,
        now: u64,
        count: usize,
        block: &mut BlockState<'_, T>,
        words: &mut Streams<LANES>,
    ) -> bool {
        let substeps = self.substeps();
        let drawn = &block.numbers[self.definition.parameters.len()..];
        self.limits.apply(&self.actions, drawn, &mut self.commands);
        self.other.copy_from_slice(block.states);
        if self.history.delays_actions() {
            self.history.act(block.past, now, &self.commands);
        }
        for substep in 0..substeps {
            if self.history.delays_actions() {
                let late = &block.episodes.delays[1];
                self.history.effective(block.past, now, substep, late, &mut self.held);
            }
            if substep > 0 && self.history.delays_observations() {
                let (q, v) = block.states.split_at(block.states.len() / 2);
                self.history.pass(block.past, now * substeps + substep, q, v);
            }
            if let Some(&length) = self.definition.lengths.get(substep as usize) {
                self.dt = T::from_f64(length);
                self.lengths = [self.dt; LANES];
            }
            if self.definition.is_jittered() {
                self.draw_lengths([now, substeps, substep], block.episodes, words);
            }
            if substep % u64::from(self.definition.inner_steps) == 0 {
                self.control(substep, block);
            }
            self.integrate(block.states, block.numbers);
        }
        self.judge(now, block);
        self.settle(block.states);
        for (paid, &reward) in block.episodes.paid.iter_mut().zip(&self.rewards) {
            *paid = *paid + reward;
        }
        self.overs[..count].iter().fold(0, |all, over| all | over) != 0
    }

    /// Draws the lengths of a step of the integrator.
    fn draw_lengths(
        &mut self,
        now: [u64; 3],
        block: &mut EpisodeBlock<T>,
        words: &mut Streams<LANES>,
    ) {
        begin_epochs(words, block, now, Purpose::StepTime);
        let [step, substeps, substep] = now;
        let clock = self.world.clock;
        let beat = Clock::<T>::beat(&clock, step * substeps + substep);
        for l in 0..LANES {
            let mut memory = ClockMemory::<T, World, 0, 0>::lane(&block.clock, l);
            let ratio: T = clock.ratio(&mut memory, beat, &mut || words.next(l));
            ClockMemory::<T, World, 0, 0>::set_lane(&mut block.clock, l, memory);
            let ratio = scale_deviation(ratio, T::one(), block.error_scale[0][l]);
            let ratio = if ratio < T::zero() { T::zero() } else { ratio };
            self.lengths[l] = self.dt * ratio;
        }
    }

    /// Computes the commands of the inner controller, if there is one, at the beginning of a substep.
    fn control(&mut self, substep: u64, block: &BlockState<'_, T>) {
        let Some(inner) = &mut self.inner else { return };
        if inner.reads_last() {
            let within = self.definition.time_of(substep as u32);
            for (age, &late) in self.times.iter_mut().zip(&block.episodes.delays[1]) {
                let periods = self.history.periods(late, substep);
                *age = T::from_f64(periods as f64 * self.span + within);
            }
        }
        let held = if self.history.delays_actions() { &self.held } else { &self.commands };
        let parameters = &block.numbers[..self.definition.parameters.len()];
        let rows = [&*block.states, parameters, held];
        let input = |i: usize| row_of(rows, i).unwrap_or(&self.times);
        inner.run(input, &mut self.inner_commands, self.instructions);
    }

    /// A step of the integrator, and its projection.
    fn integrate(&mut self, states: &mut [Row<T>], numbers: &[Row<T>]) {
        let held = match (&self.inner, self.history.delays_actions()) {
            (Some(_), _) => &self.inner_commands,
            (None, true) => &self.held,
            (None, false) => &self.commands,
        };
        let parameters = &numbers[..self.definition.parameters.len()];
        let lengths = &self.lengths;
        let inputs = [&held[..], parameters];
        let rest = |i: usize| row_of(inputs, i).unwrap_or(lengths);
        let Some(projection) = &mut self.projection else {
            return self.step.run_in_place(states, rest, self.instructions);
        };
        self.previous.copy_from_slice(states);
        self.step.run_in_place(states, rest, self.instructions);
        let count = held.len() + parameters.len() + 1;
        let previous = &self.previous;
        let rest = |i: usize| if i < count { rest(i) } else { &previous[i - count] };
        projection.run_in_place(states, rest, self.instructions);
    }

    /// Computes rewards and terminations of the step from [`other`](BlockStep::other) to these states.
    fn judge(&mut self, now: u64, block: &BlockState<'_, T>) {
        if self.is_timed[1] {
            set_times(&mut self.times, now + 1, &block.episodes.began, self.span);
        }
        let parameters = &block.numbers[..self.definition.parameters.len()];
        let rows = [&self.other[..], &self.commands, parameters, &*block.states];
        let input = |i: usize| row_of(rows, i).unwrap_or(&self.times);
        self.verdict.run(input, &mut self.judged, self.instructions);
    }

    /// Sets rewards and flags. A step that is not finite is [`LOST`] and has reward 0: a number that is not finite times zero is not
    /// zero.
    fn settle(&mut self, states: &[Row<T>]) {
        let [rewards, overs] = &self.judged;
        let mut none = rewards.map(|reward| reward * T::zero());
        for row in states.iter().chain(&self.actions) {
            none.iter_mut().zip(row).for_each(|(none, &x)| *none = *none + x * T::zero());
        }
        for l in 0..LANES {
            let lost = none[l] != T::zero();
            self.overs[l] = u8::from(overs[l] > T::zero()) | (u8::from(lost) * LOST);
            self.rewards[l] = if lost { T::zero() } else { rewards[l] };
        }
    }
}
