//! The parts of a step of a block.

use std::sync::Arc;

use libration_core::control::clock::Noise;
use libration_core::random::{Purpose, Streams};

use super::ProgramPolicy;
use super::block_state::{BlockState, Row, row_of, set_times};
use super::command_limits::CommandLimits;
use super::environment::World;
use super::row_program::ProgramRows;
use super::settlement::Settlement;
use super::state::Programs;
use crate::ensemble::{BatchFloat, InstructionSet};
use crate::rl::block_size::LANES;
use crate::rl::deviation::scale_deviation;
use crate::rl::episode_streams::begin_epochs;
use crate::rl::history::History;
use crate::rl::{ProgramEnvironment, StepIndex};

/// What all blocks and steps of a thread share, with the rows that a step fills. It is kept from call to call: to allocate the rows
/// takes as long as a step of few environments.
#[derive(Debug)]
pub(super) struct BlockStep<T> {
    pub(super) definition: Arc<ProgramEnvironment>,
    pub(super) history: History,
    pub(super) world: World,
    pub(super) instructions: InstructionSet,
    /// The length of a step of the integrator without jitter.
    pub(super) dt: T,
    /// The time from action to action, in seconds.
    pub(super) span: f64,
    limits: CommandLimits<T>,
    /// Whether observation and verdict depend on time.
    is_timed: [bool; 2],
    pub(super) step: ProgramRows<T>,
    pub(super) projection: Option<ProgramRows<T>>,
    pub(super) inner: Option<ProgramRows<T>>,
    observation: ProgramRows<T>,
    verdict: ProgramRows<T>,
    pub(super) seen: Vec<Row<T>>,
    /// The observations after a step with which an episode ended.
    pub(super) last: Vec<Row<T>>,
    pub(super) actions: Vec<Row<T>>,
    pub(super) log_probabilities: Row<T>,
    pub(super) rewards: Row<T>,
    pub(super) overs: [u8; LANES],
    pub(super) commands: Vec<Row<T>>,
    pub(super) held: Vec<Row<T>>,
    /// The commands of the inner controller.
    pub(super) inner_commands: Vec<Row<T>>,
    /// Positions and velocities at other times than now.
    other: Vec<Row<T>>,
    /// Positions and velocities before a step of the integrator, for its projection.
    pub(super) previous: Vec<Row<T>>,
    /// Positions and velocities before a step of waiting.
    pub(super) kept: Vec<Row<T>>,
    pub(super) lengths: Row<T>,
    /// The times of the answers of this step in s, where they are drawn.
    pub(super) answer_times: [f64; LANES],
    /// How many actions ago those in effect were given.
    pub(super) ages: [u32; LANES],
    pub(super) times: Row<T>,
    judged: [Row<T>; 2],
}

impl<T: BatchFloat> BlockStep<T> {
    pub(super) fn new(
        definition: Arc<ProgramEnvironment>,
        programs: &Programs,
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
            history,
            world: definition.world(),
            instructions,
            dt,
            span: definition.period(),
            limits: CommandLimits::new(&definition),
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
            kept: rows(if definition.waits() > 0 { coordinates } else { 0 }),
            lengths: [dt; LANES],
            answer_times: [0.0; LANES],
            ages: [0; LANES],
            times: zeros,
            judged: [zeros; 2],
            definition,
        }
    }

    pub(super) fn substeps(&self) -> u64 {
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
        self.limits.apply(&self.actions, drawn, &mut self.commands, self.instructions);
        if self.verdict.reads_first(self.other.len()) {
            self.other.copy_from_slice(block.states);
        }
        if self.history.delays_actions() {
            self.history.act(block.past, now, &self.commands);
        }
        if let Some(answers) = self.definition.answers {
            let episodes = &block.episodes;
            let age = |l: usize| now.saturating_sub(episodes.began[l]);
            self.answer_times = core::array::from_fn(|l| answers.draw(episodes.episode(l), age(l)));
            self.store_latencies(now, block);
        }
        for substep in 0..substeps {
            if self.history.delays_actions() {
                self.take_commands(now, substep, block);
            }
            if substep > 0 && self.history.delays_observations() {
                let (q, v) = block.states.split_at(block.states.len() / 2);
                self.history.pass(block.past, now * substeps + substep, q, v);
            }
            self.set_lengths([now, substeps, substep], block.episodes, words);
            self.control(substep, block);
            let waits = substep < self.definition.waits().into();
            if waits {
                self.kept.copy_from_slice(block.states);
            }
            self.integrate(block.states, block.numbers);
            if waits {
                self.keep_answered(block.states);
            }
        }
        self.judge(now, block);
        self.instructions.vectorize(Settlement {
            judged: &self.judged,
            finite: [block.states, &self.actions],
            rewards: &mut self.rewards,
            paid: &mut block.episodes.paid,
            overs: &mut self.overs,
        });
        self.overs[..count].iter().fold(0, |all, over| all | over) != 0
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
}
