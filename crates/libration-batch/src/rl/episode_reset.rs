//! Resets after the end of episodes.

use libration_core::Float;
use libration_core::random::Streams;

use super::block::{BlockOf, LOST, TERMINATED, TRUNCATED};
use super::block_output::BlockOutput;
use super::block_size::LANES;
use super::stepper::{Site, Stepper};
use super::{Autoreset, EpisodeEnd, Policy, StepIndex, World, block};
use crate::ensemble::kernel::at;

impl<T, E, P, const O: usize, const D: usize> Stepper<'_, T, E, P, O, D>
where
    T: Float,
    E: World<T, O, D>,
    P: Policy<T, O, D>,
{
    /// Whether all environments of a block are running.
    #[inline(always)]
    pub(super) fn all_running(&self, block: &BlockOf<T, E, O, D>) -> bool {
        self.autoreset == Autoreset::SameStep || block.ended == [0; LANES]
    }

    /// Handles the ends of episodes: records them and begins the next ones. Scalar code, because it is rare.
    #[inline(never)]
    pub(super) fn end(
        &self,
        site: &Site<T, E, O, D>,
        block: &mut BlockOf<T, E, O, D>,
        stood: Option<&BlockOf<T, E, O, D>>,
        past: &mut [T],
        words: &Streams<LANES>,
        out: &mut BlockOutput<T, O, D>,
    ) {
        let Site { place, count, systems } = *site;
        let step = place.step + 1;
        let mut last = [[T::zero(); LANES]; O];
        // Those that go on will see the same again.
        let next = Site { place: StepIndex { step, ..place }, count, systems };
        self.observe(&next, block, past, &mut words.clone(), &mut last);
        for l in count..LANES {
            // Lanes that are no environments begin anew with every end, or they would be at an end in every step.
            block.rest(l, step);
        }
        for l in 0..count {
            let environment = place.environment + l;
            let episode = block.next(l);
            if let Some(stood) = stood.filter(|stood| stood.ended[l] != 0) {
                out.step.rewards[l] = T::zero();
                let flags = if self.autoreset == Autoreset::Disabled { stood.ended[l] } else { 0 };
                (out.overs[l], out.cuts[l]) = (flags & TERMINATED, (flags & TRUNCATED) / TRUNCATED);
                if self.autoreset == Autoreset::Disabled {
                    block.hold(stood, l);
                    let steps = place.step * self.substeps..step * self.substeps;
                    self.history.hold(past, l, steps, stood.state(l).coordinates());
                } else {
                    block::begin(block, self.history, past, self.world, l, episode, step);
                }
                continue;
            }
            let lost = out.overs[l] & LOST != 0;
            out.overs[l] = u8::from(out.overs[l] != 0);
            let flags = out.overs[l] * TERMINATED + out.cuts[l] * TRUNCATED;
            if flags == 0 {
                continue;
            }
            out.finals.push(EpisodeEnd {
                step: place.row,
                environment,
                observation: at(&last, l),
                episode_return: block.paid(l),
                length: step - block.began[l],
                lost,
            });
            match self.autoreset {
                Autoreset::SameStep => {
                    block::begin(block, self.history, past, self.world, l, episode, step);
                }
                Autoreset::NextStep | Autoreset::Disabled => block.ended[l] = flags,
            }
        }
        block.settle();
    }
}
