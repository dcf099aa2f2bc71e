//! Environments as they are seen from outside.

use bytemuck::Pod;

use super::kernel::LANES;
use super::stage::{Site, Stage};
use super::strip::first_of;
use super::{EnvironmentError, Environments, Place, Sensor, World, policy};
use crate::Float;
use crate::ensemble::Assign;
use crate::random::Streams;

impl<T, E, const O: usize, const D: usize> Environments<T, E, O, D>
where
    T: Float + Pod,
    E: World<T, O, D>,
{
    /// Writes what is seen now, before the next action: `[n, i]`.
    ///
    /// # Errors
    /// [`EnvironmentError::Shape`] if that is not the length of `to`.
    pub fn observe(&mut self, mut to: &mut [T]) -> Result<(), EnvironmentError> {
        EnvironmentError::shape("numbers to be observed", to.len(), self.len.saturating_mul(O))?;
        let Environments { world, history, step, len, .. } = *self;
        let (sensor, systems) = (world.parts().sensor, world.parts().systems);
        let words = self.draws[1].prepare(&self.blocks, [step, 1], 0, sensor.words());
        // A look needs no policy.
        let nobody = policy::Constant([0.0; D]);
        let stage = Stage::<T, E, _, O, D>::new(&world, nobody, history);
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
                let place = Place { environment, environments: len, step, row: 0 };
                let site = Site { place, count, systems };
                let past = &mut past[b * history.len()..][..history.len()];
                let mut words = words.get(from + b).copied().unwrap_or_else(Streams::none);
                let mut seen = [[T::zero(); LANES]; O];
                stage.look(&site, block, past, &mut words, &mut seen);
                let rows = to[b * LANES * O..][..count * O].chunks_exact_mut(O.max(1));
                for (l, row) in rows.enumerate() {
                    (0..O).for_each(|i| row[i] = seen[i][l]);
                }
            }
        });
        Ok(())
    }
}
