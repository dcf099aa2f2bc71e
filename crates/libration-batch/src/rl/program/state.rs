//! The state of environments: blocks, and the programs that step them.

use libration_core::{Float, with_method};
use libration_equations::StepProgram;

use super::ProgramEnvironment;
use super::block_state::{BlockState, Row};
use super::environment::World;
use super::row_program::RowProgram;
use crate::ensemble::InstructionSet;
use crate::rl::history::History;
use crate::rl::start::uniform;
use crate::rl::{Delays, Episode, block};

/// The programs of environments.
#[derive(Debug)]
pub(super) struct Programs {
    pub(super) step: RowProgram,
    pub(super) projection: Option<RowProgram>,
    pub(super) inner: Option<RowProgram>,
    pub(super) observation: RowProgram,
    pub(super) verdict: RowProgram,
}

impl Programs {
    pub(super) fn new(definition: &ProgramEnvironment) -> Self {
        let ProgramEnvironment { dynamics, task, method, .. } = definition;
        let step = with_method!(method, |method| StepProgram::new(method, dynamics));
        let (coordinates, inputs) = (definition.coordinates(), dynamics.inputs());
        let dt = coordinates + inputs;
        let uniform = definition.is_even().then_some(dt);
        let observed = coordinates + definition.parameters.len() + 1;
        let (projection, actions) = (task.projection.as_ref(), definition.actions());
        let controlled = coordinates + definition.parameters.len() + actions + 1;
        let judged = 2 * coordinates + actions + definition.parameters.len() + 1;
        Programs {
            step: RowProgram::new(step.program(), dt + 1, uniform),
            projection: projection.map(|all| RowProgram::new(all, dt + 1 + coordinates, uniform)),
            inner: task.inner.as_ref().map(|all| RowProgram::new(all, controlled, None)),
            observation: RowProgram::new(&task.observation, observed, None),
            verdict: RowProgram::new(&task.verdict, judged, None),
        }
    }

    /// Whether observation and verdict depend on time, the last input of each.
    pub(super) fn is_timed(&self) -> [bool; 2] {
        [&self.observation, &self.verdict].map(RowProgram::reads_last)
    }

    /// The length of an action in shortest steps of an ensemble.
    pub(super) fn shortest_steps(&self, substeps: u32) -> u64 {
        let others = [&self.projection, &self.inner].into_iter().flatten();
        let others: u64 = others.map(RowProgram::shortest_steps).sum();
        let steps = (self.step.shortest_steps() + others).saturating_mul(substeps.into());
        steps + self.observation.shortest_steps() + self.verdict.shortest_steps()
    }
}

/// What begins an episode.
#[derive(Clone, Copy)]
pub(super) struct Beginning<'a> {
    definition: &'a ProgramEnvironment,
    world: &'a World,
    history: History,
    instructions: InstructionSet,
    /// Whether episodes draw nothing but their starts, so that all else is what it was in the episode before.
    is_same: bool,
}

impl<'a> Beginning<'a> {
    pub(super) fn new(
        definition: &'a ProgramEnvironment,
        world: &'a World,
        history: History,
        instructions: InstructionSet,
    ) -> Self {
        let varies = world.delays.varies() || world.error_scale.varies();
        let is_same =
            !varies && definition.skew.rms() == 0.0 && definition.numbers().next().is_none();
        Beginning { definition, world, history, instructions, is_same }
    }

    /// The same, where the episodes before may have been those of another definition.
    pub(super) fn with_all_draws(self) -> Self {
        Beginning { is_same: false, ..self }
    }

    /// Begins the next episode of environment `n` in lane `l` of its block, with the step `now`.
    pub(super) fn begin<T: Float>(
        &self,
        block: &mut BlockState<'_, T>,
        [n, l]: [usize; 2],
        now: u64,
    ) {
        let episode = block.episodes.next(l);
        if self.is_same {
            block.episodes.renew(l, episode.number, now);
        } else {
            block::begin(block.episodes, no_history(), &mut [], self.world, l, episode, now);
            self.draw(block.numbers, [n, l], episode);
        }
        let ranges = &self.definition.start;
        uniform::start(episode, ranges, self.instructions, |i, x| block.states[i][l] = x);
        if self.history.len() > 0 {
            self.history.begin(block.past, l, block.states.iter().map(|row| row[l]));
        }
    }

    /// Draws the numbers of an episode of environment `n` in lane `l` of its block.
    pub(super) fn draw<T: Float>(
        &self,
        numbers: &mut [Row<T>],
        [n, l]: [usize; 2],
        episode: Episode,
    ) {
        for (i, (row, number)) in numbers.iter_mut().zip(self.definition.numbers()).enumerate() {
            row[l] = T::from_f64(number.of(episode, i, n));
        }
    }

    /// Puts lane `l` at a state that nothing was before.
    pub(super) fn place<T: Float>(
        &self,
        states: &mut [Row<T>],
        past: &mut [T],
        l: usize,
        state: impl Iterator<Item = T>,
    ) {
        states.iter_mut().zip(state).for_each(|(row, x)| row[l] = x);
        self.history.begin(past, l, states.iter().map(|row| row[l]));
    }
}

/// The past of blocks without states.
fn no_history() -> History {
    History::new(Delays::default(), 1, [0, 0])
}
