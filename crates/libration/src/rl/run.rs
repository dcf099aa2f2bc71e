//! Environments through a horizon.

use core::mem::swap;

use bytemuck::Pod;

use super::error::NOTHING_DRAWN;
use super::kernel::{Horizon, LANES, Share, TILE};
use super::strip::first_of;
use super::{Autoreset, EnvironmentError, Environments, Final, Policy, Rollout, Sensor, World};
use crate::Float;
use crate::control::Clock;
use crate::control::error::ensure;
use crate::ensemble::{EnsembleError, NoRoom};

impl<T, E, const O: usize, const D: usize> Environments<T, E, O, D>
where
    T: Float + Pod,
    E: World<T, O, D>,
{
    /// Fills `rollout` with what all do under `policy`.
    ///
    /// # Errors
    /// [`EnvironmentError::Shape`] if it is for another number of environments, or the policy is;
    /// [`EnvironmentError::Field`] if it has no room for something that has to be said; [`EnvironmentError::Ensemble`] if a record of the
    /// clock ends before, or if there is no memory for the ends of episodes that the time limit alone makes.
    pub fn rollout<P: Policy<T, O, D>>(
        &mut self,
        policy: P,
        rollout: &mut Rollout<T, O, D>,
    ) -> Result<(), EnvironmentError> {
        let plan = rollout.plan();
        let (horizon, len) = (plan.horizon, self.len);
        EnvironmentError::shape("environments of the rollout", plan.environments, len)?;
        policy.check(len, horizon)?;
        let drawn = if P::DRAWS { "at least 1, since it draws" } else { NOTHING_DRAWN };
        ensure("random words of the policy", policy.words() as f64, drawn, |n| {
            P::DRAWS == (n > 0.0)
        })?;
        let parts = self.world.parts();
        if parts.limit.is_some() && !plan.truncated {
            let (why, field) = ("the environments have a time limit", "truncated");
            return Err(EnvironmentError::Field { why, field });
        }
        let (steps, substeps) = (horizon as u64, u64::from(parts.substeps));
        let asked = self.step.saturating_add(steps).saturating_mul(substeps);
        if let Some(known) = parts.clock.steps().filter(|&known| known < asked) {
            return Err(EnsembleError::Record { known, asked }.into());
        }
        // So many ends the limit makes, and to gather them takes as much again. To ask the system costs as long as a short rollout: it
        // is asked where they are more than what the plan was asked for.
        let cuts = parts.limit.map_or(0, |l| len as u128 * (horizon as u128 / u128::from(l)));
        let needed = cuts.saturating_mul(2 * size_of::<Final<T, O>>() as u128);
        if needed > plan.bytes(O, D, size_of::<T>()) {
            NoRoom::check(needed)?;
        }
        let threads = plan.threads(&self.execution);
        // Whole tiles where there are enough for all threads.
        let tile = TILE.min(len.div_ceil(threads).next_multiple_of(LANES)).max(LANES);
        let tiles = len.div_ceil(tile);
        let counts: Vec<usize> = (0..threads)
            .map(|i| [i, i + 1].map(|i| (tiles * i / threads * tile).min(len)))
            .map(|[from, to]| to - from)
            .collect();
        rollout.pauses = parts.autoreset != Autoreset::SameStep;
        rollout.idle = if rollout.pauses { self.standing() } else { Vec::new() };

        let Environments { world, history, step, .. } = *self;
        let [times, looks, acts] = &mut self.draws;
        let blocks = &self.blocks[..];
        let words = world.parts().clock.words();
        let times = times.prepare(blocks, [step, substeps], steps, words);
        let words = world.parts().sensor.words();
        let looks = looks.prepare(blocks, [step, 1], steps, words);
        let acts = acts.prepare(blocks, [step, 1], steps, policy.words());
        let mut rest = (&mut self.blocks[..], &mut self.past[..], [times, looks, acts]);
        let mut first = 0;
        let mut shares = Vec::with_capacity(counts.len());
        let mut all = rollout.strip();
        for &len in &counts {
            let count = len.div_ceil(LANES);
            let share = Share {
                first,
                len,
                blocks: first_of(&mut rest.0, count),
                past: first_of(&mut rest.1, count * history.len()),
                words: rest.2.each_mut().map(|words| first_of(words, count)),
            };
            shares.push((share, all.split_off(len)));
            first += len;
        }
        let instructions = self.execution.instruction_set();
        let finals = self.execution.each(shares, |(share, strip)| {
            instructions.run(Horizon::<T, E, P, _, O, D> {
                world: &world,
                policy,
                history,
                environments: len,
                step,
                share,
                strip,
                writes: plan.writes,
            })
        });
        rollout.finals.clear();
        for mut ends in finals {
            if rollout.finals.is_empty() {
                // With one thread these are all, and nothing is copied.
                swap(&mut rollout.finals, &mut ends);
            }
            rollout.finals.append(&mut ends);
        }
        rollout.finals.sort_unstable_by_key(|end| (end.step, end.environment));
        self.step = self.step.saturating_add(steps);
        Ok(())
    }

    /// Those that stand still.
    fn standing(&self) -> Vec<usize> {
        let stands = |n: &usize| self.blocks[n / LANES].ended[n % LANES] != 0;
        (0..self.len).filter(stands).collect()
    }
}
