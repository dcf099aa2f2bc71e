//! A batch of environments by programs.

use core::iter::repeat_with;
use core::ops::Range;
use std::sync::Arc;

use libration_core::Float;
use libration_core::control::Clock;
use ndarray::ArrayViewMut3;

use super::block_state::Row;
use super::block_step::BlockStep;
use super::episodes::Episodes;
use super::horizon::{Horizon, Share};
use super::state::{Beginning, Programs};
use super::transitions::Transitions;
use super::{EpisodeEnds, ProgramEnvironment, ProgramPolicy, ProgramRollout};
use crate::ensemble::{BatchFloat, Execution, InsufficientMemory};
use crate::rl::block_size::LANES;
use crate::rl::history::History;
use crate::rl::plan::shortest_steps;
use crate::rl::rollout_slice::{first_of, rows_of};
use crate::rl::{EnvironmentError, StepBuffers};

/// A batch of [`ProgramEnvironment`]s that are stepped together: [`Environments`](crate::rl::Environments) with any number of states,
/// inputs and observations.
#[derive(Debug)]
pub struct ProgramEnvironments<T: Float> {
    pub(super) definition: Arc<ProgramEnvironment>,
    programs: Programs,
    /// See [`Programs::shortest_steps`].
    shortest_steps: u64,
    /// The rows of each thread so far.
    works: Vec<BlockStep<T>>,
    pub(super) episodes: Episodes<T>,
    /// Positions, then velocities, of each block.
    pub(super) states: Vec<Row<T>>,
    /// The numbers of the episodes of each block.
    pub(super) numbers: Vec<Row<T>>,
    pub(super) history: History,
    pub(super) past: Vec<T>,
    /// Whether episodes may have begun under another definition.
    pub(super) is_foreign: bool,
}

impl<T: BatchFloat> ProgramEnvironments<T> {
    /// `len` environments from number `first` of a larger batch on, each at the start of its first episode. `seed` determines all
    /// random numbers.
    ///
    /// # Errors
    /// As for [`Environments::shard`](crate::rl::Environments::shard), and [`EnvironmentError::Shape`] for a wrong number of ranges,
    /// limits or laws.
    pub fn shard(
        definition: ProgramEnvironment,
        first: usize,
        len: usize,
        seed: u64,
        execution: Execution,
    ) -> Result<Self, EnvironmentError> {
        definition.check::<T>(len)?;
        let world = definition.world();
        let episodes = Episodes::shard(world, first, len, seed, execution)?;
        let history = definition.history();
        let blocks = len.div_ceil(LANES);
        let [rows, drawn] = [definition.coordinates(), definition.numbers().count()]
            .map(|each| blocks.saturating_mul(each));
        let numbers = rows.saturating_add(drawn).saturating_mul(LANES);
        let numbers = numbers.saturating_add(blocks.saturating_mul(history.len()));
        InsufficientMemory::check(numbers as u128 * size_of::<T>() as u128)?;
        let programs = Programs::new(&definition);
        let mut all = ProgramEnvironments {
            shortest_steps: programs.shortest_steps(definition.substeps),
            programs,
            works: Vec::new(),
            states: vec![[T::zero(); LANES]; rows],
            numbers: vec![[T::zero(); LANES]; drawn],
            past: vec![T::zero(); blocks * history.len()],
            definition: Arc::new(definition),
            episodes,
            history,
            is_foreign: false,
        };
        (0..len).for_each(|n| all.place(n));
        Ok(all)
    }

    /// The number of environments.
    pub fn len(&self) -> usize {
        self.episodes.len()
    }

    /// Whether the batch is empty.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The number of actions of each environment so far.
    pub fn step(&self) -> u64 {
        self.episodes.step()
    }

    /// Sets the execution. Results do not depend on it.
    pub fn execute(&mut self, execution: Execution) {
        // They are of the instruction set before.
        self.works.clear();
        self.episodes.execute(execution);
    }

    /// The definition of the environments.
    pub fn definition(&self) -> &ProgramEnvironment {
        &self.definition
    }

    /// Writes the observations before the next action: `[n, i]`.
    ///
    /// # Errors
    /// [`EnvironmentError::Shape`] if that is not the length of `to`.
    pub fn observe(&mut self, to: &mut [T]) -> Result<(), EnvironmentError> {
        let wanted = self.len().saturating_mul(self.definition.observations());
        EnvironmentError::shape("observed numbers", to.len(), wanted)?;
        let nothing = transitions(&mut [], [0, self.len()]);
        self.run(ProgramPolicy::ActionSequence(&[]), nothing, to, 0);
        Ok(())
    }

    /// Fills `rollout` with the transitions of all environments under `policy`.
    ///
    /// # Errors
    /// See [`Environments::rollout`](crate::rl::Environments::rollout).
    pub fn rollout(
        &mut self,
        policy: ProgramPolicy<'_, T>,
        rollout: &mut ProgramRollout<T>,
    ) -> Result<(), EnvironmentError> {
        let horizon = rollout.transitions.plan().horizon;
        self.fill(policy, rollout, 0..horizon)
    }

    /// Fills a range of rows of `rollout`; the rows before must be full.
    ///
    /// # Errors
    /// See [`Environments::fill`](crate::rl::Environments::fill).
    pub fn fill(
        &mut self,
        policy: ProgramPolicy<'_, T>,
        rollout: &mut ProgramRollout<T>,
        rows: Range<usize>,
    ) -> Result<(), EnvironmentError> {
        let plan = rollout.transitions.plan();
        let [observations, actions] = rollout.sizes();
        let wanted = self.definition.observations();
        EnvironmentError::shape("observed numbers of the rollout", observations, wanted)?;
        let wanted = self.definition.actions();
        EnvironmentError::shape("actions of the rollout", actions, wanted)?;
        self.episodes.expect_rows(&plan, &rows, rollout.sizes())?;
        self.ready(policy, plan.horizon)?;
        self.episodes.begin_rows(&mut rollout.transitions, rows.start);
        if rows.start == 0 {
            rollout.last.clear();
        }
        let ends = self.run(policy, rollout.rows(&rows), &mut [], rows.start);
        rollout.transitions.finals.extend(ends.ends);
        rollout.last.extend(ends.observations);
        Ok(())
    }

    /// Takes one action of each environment and writes the results. Returns the ends of episodes.
    ///
    /// # Errors
    /// See [`Environments::act`](crate::rl::Environments::act).
    pub fn act(
        &mut self,
        policy: ProgramPolicy<'_, T>,
        to: StepBuffers<'_, T>,
    ) -> Result<EpisodeEnds<T>, EnvironmentError> {
        let len = self.len();
        to.check([len, self.definition.observations()])?;
        self.ready(policy, 1)?;
        let mut step = transitions(to.reward, [1, len]);
        step.terminated = rows_of(to.terminated, 1);
        step.truncated = rows_of(to.truncated, 1);
        Ok(self.run(policy, step, to.seen, 0))
    }

    fn ready(&self, policy: ProgramPolicy<'_, T>, horizon: usize) -> Result<(), EnvironmentError> {
        let sizes = [self.definition.observations(), self.definition.actions()];
        policy.check(sizes, [self.len(), horizon])
    }

    /// Runs all steps, from row `row` of the rollout on, and writes the observations after them.
    fn run<'a>(
        &'a mut self,
        policy: ProgramPolicy<'_, T>,
        mut to: Transitions<'a, T>,
        mut next: &'a mut [T],
        row: usize,
    ) -> EpisodeEnds<T> {
        let len = self.len();
        let steps = to.reward.nrows() as u64;
        let each = self.shortest_steps.saturating_add(shortest_steps(policy.operations()));
        let ProgramEnvironments { definition, programs, works, episodes, .. } = self;
        let ProgramEnvironments { states, numbers, history, past, is_foreign, .. } = self;
        let (coordinates, observations) = (definition.coordinates(), definition.observations());
        let drawn = definition.numbers().count();
        let Episodes { world, blocks, draws: [times, looks, acts], step, .. } = episodes;
        let substeps = u64::from(definition.substeps);
        let words = if definition.is_jittered() { Clock::<T>::words(&world.clock) } else { 0 };
        let times = times.prepare(blocks, [*step, substeps], steps, words);
        let laws = definition.noise.iter().map(libration_core::control::clock::Noise::words);
        let words = if definition.is_noisy() { laws.sum() } else { 0 };
        let looks = looks.prepare(blocks, [*step, 1], steps, words);
        let acts = acts.prepare(blocks, [*step, 1], steps, policy.words());

        let work = (len as u64).saturating_mul(steps.max(1));
        let threads = episodes.execution.threads_for(work.saturating_mul(each));
        let size = len.div_ceil(threads).next_multiple_of(LANES).max(LANES);
        let mut rest = (&mut blocks[..], &mut states[..], &mut past[..], [times, looks, acts]);
        let mut numbers = &mut numbers[..];
        let mut shares = Vec::with_capacity(threads);
        for first in (0..len).step_by(size) {
            let len = size.min(len - first);
            let count = len.div_ceil(LANES);
            let (head, tail) = to.split_off(len);
            to = tail;
            shares.push(Share {
                first,
                len,
                blocks: first_of(&mut rest.0, count),
                states: first_of(&mut rest.1, count * coordinates),
                numbers: first_of(&mut numbers, count * drawn),
                past: first_of(&mut rest.2, count * history.len()),
                words: rest.3.each_mut().map(|words| first_of(words, count)),
                to: head,
                next: first_of(&mut next, len * observations),
            });
        }
        let instructions = episodes.execution.instruction_set();
        let beginning = Beginning::new(definition, world, *history, instructions);
        let beginning = if *is_foreign { beginning.with_all_draws() } else { beginning };
        let horizon = Horizon { beginning, policy, environments: len, step: *step, row };
        let missing = shares.len().saturating_sub(works.len());
        let new = || {
            let definition = Arc::clone(definition);
            BlockStep::new(definition, programs, *history, instructions, len)
        };
        works.extend(repeat_with(new).take(missing));
        let parts = shares.into_iter().zip(works.iter_mut()).collect();
        let each = episodes.execution.each(parts, |(share, work)| horizon.run(work, share));
        *step = step.saturating_add(steps);
        EpisodeEnds::in_order(each, observations)
    }
}

/// Transitions of which only rewards are written, for `[t, n]`.
fn transitions<T>(reward: &mut [T], [steps, len]: [usize; 2]) -> Transitions<'_, T> {
    let nothing = || ArrayViewMut3::from_shape((steps, len, 0), &mut [][..]).expect("no numbers");
    Transitions {
        observation: nothing(),
        action: nothing(),
        reward: rows_of(reward, steps),
        terminated: rows_of(&mut [], steps),
        truncated: rows_of(&mut [], steps),
        log_probability: rows_of(&mut [], steps),
    }
}
