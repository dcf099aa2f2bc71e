//! Observations of environments outside a rollout.

use bytemuck::Pod;
use libration_core::Float;
use libration_core::random::Streams;

use super::block::BlockOf;
use super::block_size::LANES;
use super::rollout_row::interleave;
use super::rollout_slice::first_of;
use super::stepper::{Site, Stepper};
use super::{EnvironmentError, Environments, Policy, Sensor, StepIndex, World, policy};
use crate::ensemble::Assign;

impl<T, E, const O: usize, const D: usize> Environments<T, E, O, D>
where
    T: Float + Pod,
    E: World<T, O, D>,
{
    /// Writes the observations before the next action: `[n, i]`.
    ///
    /// # Errors
    /// [`EnvironmentError::Shape`] if that is not the length of `to`.
    pub fn observe(&mut self, mut to: &mut [T]) -> Result<(), EnvironmentError> {
        EnvironmentError::shape("observed numbers", to.len(), self.len.saturating_mul(O))?;
        let Environments { world, history, step, len, .. } = *self;
        let (sensor, systems) = (world.parts().sensor, world.parts().systems);
        let words = self.draws[1].prepare(&self.blocks, [step, 1], 0, sensor.words());
        // A look needs no policy.
        let nobody = policy::Constant([0.0; D]);
        let stepper = Stepper::<T, E, _, O, D>::new(&world, nobody, history);
        let threads = self.execution.threads_for(len as u64);
        let share = self.blocks.len().div_ceil(threads).max(1);
        let mut past = &mut self.past[..];
        let mut shares = Vec::with_capacity(threads);
        for (i, blocks) in self.blocks.chunks(share).enumerate() {
            let to = first_of(&mut to, share * LANES * O);
            shares.push((i * share, blocks, to, first_of(&mut past, share * history.len())));
        }
        let words = &*words;
        self.execution.each(shares, |(from, blocks, to, past)| {
            for (b, block) in blocks.iter().enumerate() {
                let environment = (from + b) * LANES;
                let count = (len - environment).min(LANES);
                let systems = systems.lanes::<LANES>(environment, count);
                let place = StepIndex { environment, environments: len, step, row: 0 };
                let site = Site { place, count, systems };
                let past = &mut past[b * history.len()..][..history.len()];
                let none = Streams::none();
                let words = words.get(from + b).unwrap_or(&none);
                stepper.write_observations(&site, block, past, words, &mut to[b * LANES * O..]);
            }
        });
        Ok(())
    }
}

impl<T, E, P, const O: usize, const D: usize> Stepper<'_, T, E, P, O, D>
where
    T: Float + Pod,
    E: World<T, O, D>,
    P: Policy<T, O, D>,
{
    /// Writes the observations of a block before an action, interleaved, without advancing the words of its sensors.
    #[inline(always)]
    pub(super) fn write_observations(
        &self,
        site: &Site<T, E, O, D>,
        block: &BlockOf<T, E, O, D>,
        past: &mut [T],
        words: &Streams<LANES>,
        to: &mut [T],
    ) {
        let mut seen = [[T::zero(); LANES]; O];
        self.observe(site, block, past, &mut words.clone(), &mut seen);
        if const { O == 0 } {
            return;
        }
        if let (LANES, Some(to)) = (site.count, to.as_chunks_mut().0.first_chunk_mut()) {
            interleave(&seen, to);
            return;
        }
        for (l, row) in to.chunks_exact_mut(O).take(site.count).enumerate() {
            (0..O).for_each(|i| row[i] = seen[i][l]);
        }
    }
}
