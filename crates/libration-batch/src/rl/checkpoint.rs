//! Checkpoints of environments.

use bytemuck::Pod;
use libration_core::Float;
use libration_core::control::Memory;

use super::block::{BlockOf, ClockMemory, Numbers, TERMINATED, TRUNCATED};
use super::block_size::LANES;
use super::episode_streams::EpisodeStreams;
use super::{Environments, World, block};
use crate::checkpoint::{Checkpoint, CheckpointError, Reader, Trait};

impl<T, E, const O: usize, const D: usize> Environments<T, E, O, D>
where
    T: Float + Pod,
    E: World<T, O, D>,
{
    /// Numbers of a block: coordinates, reward sum, error scales, memory of the clock and parameters of the episode.
    const NUMBERS: usize = 2 * D + 3 + ClockMemory::<T, E, O, D>::LEN + Numbers::<T, E, O, D>::LEN;

    /// Bytes of a block.
    const BLOCK: usize = LANES * (Self::NUMBERS * size_of::<T>() + 8 + 2 * 4 + 4 * 8 + 1);

    fn save_block<X>(
        block: &BlockOf<T, E, O, D>,
        mut sink: impl FnMut(&[u8]) -> Result<(), X>,
    ) -> Result<(), X> {
        for row in block.q.iter().chain(&block.v).chain([&block.paid]).chain(&block.error_scale) {
            sink(bytemuck::cast_slice(row))?;
        }
        let mut rows = Vec::new();
        ClockMemory::<T, E, O, D>::store(&block.clock, &mut |_, row| rows.push(*row));
        Numbers::<T, E, O, D>::store(&block.numbers, &mut |_, row| rows.push(*row));
        rows.iter().try_for_each(|row| sink(bytemuck::cast_slice(row)))?;
        sink(bytemuck::cast_slice(&block.banked))?;
        block.delays.iter().try_for_each(|row| sink(bytemuck::cast_slice(row)))?;
        sink(bytemuck::cast_slice(&block.began))?;
        for row in [&block.episode, &block.seed, &block.environment] {
            sink(bytemuck::cast_slice(row))?;
        }
        sink(&block.ended)
    }

    fn load_block(block: &mut BlockOf<T, E, O, D>, from: &mut Reader<'_>) {
        for row in block.q.iter_mut().chain(&mut block.v) {
            from.fill(row);
        }
        from.fill(&mut block.paid);
        block.error_scale.iter_mut().for_each(|row| from.fill(row));
        let mut rows = |count: usize| -> Vec<[T; LANES]> {
            let mut rows = vec![[T::zero(); LANES]; count];
            rows.iter_mut().for_each(|row| from.fill(row));
            rows
        };
        let clock = rows(ClockMemory::<T, E, O, D>::LEN);
        block.clock = ClockMemory::<T, E, O, D>::load(&|i| clock[i]);
        let numbers = rows(Numbers::<T, E, O, D>::LEN);
        block.numbers = Numbers::<T, E, O, D>::load(&|i| numbers[i]);
        from.fill(&mut block.banked);
        block.delays.iter_mut().for_each(|row| from.fill(row));
        from.fill(&mut block.began);
        from.fill(&mut block.episode);
        from.fill(&mut block.seed);
        from.fill(&mut block.environment);
        from.fill(&mut block.ended);
        block.settle();
    }
}

impl<T, E, const O: usize, const D: usize> Checkpoint for Environments<T, E, O, D>
where
    T: Float + Pod,
    E: World<T, O, D>,
{
    fn traits(&self) -> Vec<Trait> {
        let parts = self.world.parts();
        vec![
            ("kind", "environments".to_owned()),
            ("float type", T::NAME.to_owned()),
            ("number of dimensions", D.to_string()),
            ("number of observations", O.to_string()),
            ("number of environments", self.len.to_string()),
            ("number of the first environment", self.first.to_string()),
            ("seed", self.seed.to_string()),
            ("time step", format!("{:?}", parts.dt)),
            ("number of substeps", parts.substeps.to_string()),
            ("number of actions and states on their way", self.history.len().to_string()),
            ("number of what is kept of an environment", Self::NUMBERS.to_string()),
        ]
    }

    fn save<X>(&self, mut sink: impl FnMut(&[u8]) -> Result<(), X>) -> Result<(), X> {
        sink(bytemuck::bytes_of(&self.step))?;
        let whole = self.len / LANES;
        let (blocks, last) = self.blocks.split_at(whole);
        blocks.iter().try_for_each(|block| Self::save_block(block, &mut sink))?;
        // Of lanes that are no environments nobody knows what they are.
        let count = self.len % LANES;
        for block in last {
            let mut block = *block;
            (count..LANES).for_each(|l| clear::<T, E, O, D>(&mut block, l));
            Self::save_block(&block, &mut sink)?;
        }
        let (past, last) = self.past.split_at(whole * self.history.len());
        sink(bytemuck::cast_slice(past))?;
        let mut last = last.to_vec();
        last.chunks_mut(LANES).for_each(|row| row[count..].fill(T::zero()));
        sink(bytemuck::cast_slice(&last))
    }

    fn restore(&mut self, state: &[u8]) -> Result<(), CheckpointError> {
        let wanted = 8 + self.blocks.len() * Self::BLOCK + size_of_val(&self.past[..]);
        let mut from = Reader::new(state, wanted)?;
        let step = from.next();
        // Nobody takes so many steps, and what follows can be counted.
        if step > FURTHEST {
            return Err(CheckpointError::Damaged(format!("its step is {step}")));
        }
        let mut blocks = self.blocks.clone();
        blocks.iter_mut().for_each(|block| Self::load_block(block, &mut from));
        let most = self.world.parts().delays;
        let most = [most.observation[1], most.action[1]];
        for (n, block) in blocks.iter().enumerate() {
            let late = |i: usize| block.delays[i].iter().any(|&delay| delay > most[i]);
            let ahead = block.began.iter().any(|&began| began > step);
            let ahead = ahead || block.episode.iter().any(|&episode| episode > FURTHEST);
            let ended = block.ended.iter().any(|&ended| ended > (TERMINATED | TRUNCATED));
            if late(0) || late(1) || ahead || ended {
                let first = n * LANES;
                let what =
                    format!("the state of the environments from number {first} on is inconsistent");
                return Err(CheckpointError::Damaged(what));
            }
        }
        (self.step, self.blocks) = (step, blocks);
        self.draws.iter_mut().for_each(EpisodeStreams::invalidate);
        from.fill(&mut self.past);
        Ok(())
    }
}

/// The largest number of steps or episodes in a state.
const FURTHEST: u64 = 1 << 52;

/// Resets lane `l` to its state before the first episode.
fn clear<T: Float, E: World<T, O, D>, const O: usize, const D: usize>(
    block: &mut BlockOf<T, E, O, D>,
    l: usize,
) {
    let none = block::empty::<T, E, O, D>();
    let rows = block.q.iter_mut().chain(&mut block.v).chain([&mut block.paid]);
    rows.for_each(|row| row[l] = T::zero());
    let clock = ClockMemory::<T, E, O, D>::lane(&none.clock, l);
    ClockMemory::<T, E, O, D>::set_lane(&mut block.clock, l, clock);
    let numbers = Numbers::<T, E, O, D>::lane(&none.numbers, l);
    Numbers::<T, E, O, D>::set_lane(&mut block.numbers, l, numbers);
    block.error_scale.iter_mut().for_each(|row| row[l] = T::one());
    block.delays.iter_mut().for_each(|row| row[l] = 0);
    (block.banked[l], block.began[l], block.episode[l], block.ended[l]) = (0.0, 0, 0, 0);
    (block.seed[l], block.environment[l]) = (0, 0);
}
