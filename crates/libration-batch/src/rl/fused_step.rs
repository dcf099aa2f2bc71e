//! The fused step: observation, action and integration in one loop.

use bytemuck::Pod;
use libration_core::control::Clock;
use libration_core::random::{Purpose, Streams};
use libration_core::system::CommandedSystem;
use libration_core::{Float, Integrator};

use super::block::BlockOf;
use super::block_output::Step;
use super::block_size::LANES;
use super::episode_streams::begin_epochs;
use super::rollout_row::{Records, RolloutRow, Writer};
use super::stepper::{Site, Stepper, evaluate, lane};
use super::{Parts, Policy, Sensor, Task, World};
use crate::ensemble::instructions::Target;
use crate::ensemble::kernel::put;

impl<T, E, P, const O: usize, const D: usize> Stepper<'_, T, E, P, O, D>
where
    T: Float + Pod,
    E: World<T, O, D>,
    P: Policy<T, O, D>,
{
    /// Whether a step can be fused: a closed-form policy, no delays, an ideal clock and an ideal sensor.
    pub(super) fn is_fused(&self) -> bool {
        let ideal = const { P::CLOSED_FORM && !E::Sensor::DRAWS && E::Clock::EVEN };
        let timely = !self.history.delays_observations() && !self.history.delays_actions();
        ideal && timely && self.substeps == 1 && self.is_unlimited_acceleration()
    }

    /// Takes an ideal step of a whole block and writes its numbers. One loop computes all of it, so that values stay in registers
    /// until they are written.
    #[inline(always)]
    // Gathered in a struct, arguments would stay in memory.
    #[allow(clippy::too_many_arguments, clippy::needless_range_loop)]
    pub(super) fn fused_step<I: Target>(
        &self,
        parts: Parts<T, E, O, D>,
        site: &Site<T, E, O, D>,
        block: &mut BlockOf<T, E, O, D>,
        words: &mut Streams<LANES>,
        overs: &mut [u8; LANES],
        b: usize,
        row: &mut RolloutRow<'_, T, O, D>,
        writer: &Writer<I>,
        records: &mut Records<T, O, D>,
    ) -> u8 {
        if const { P::DRAWS } {
            begin_epochs(words, block, [site.place.step, 1, 0], Purpose::Action);
        }
        let (policy, dt) = (self.policy, self.dt);
        let mut ended = 0;
        let mut out = Step {
            seen: [[T::zero(); LANES]; O],
            actions: [[T::zero(); LANES]; D],
            rewards: [T::zero(); LANES],
            log_probabilities: [T::zero(); LANES],
        };
        let mut drawn = *words;
        for l in 0..LANES {
            let (system, task) = lane::<T, E, O, D>(&parts, &site.systems, &block.numbers, l);
            let before = block.state(l);
            let time = self.time(site.place.step, block.began[l]);
            let seen = task.observe(time, &before);
            let act = policy.act(site.place.lane(l), &seen, &mut || drawn.next(l));
            let system = CommandedSystem { system, command: act.action };
            let after = parts.method.step(&system, before, dt);
            // An action that is no number leaves no state that is one.
            let time = self.time(site.place.step + 1, block.began[l]);
            let (reward, over) = evaluate(&task, true, time, &before, &act.action, &after);
            put(&mut out.seen, l, seen);
            put(&mut out.actions, l, act.action);
            out.log_probabilities[l] = act.log_probability;
            out.rewards[l] = reward;
            block.paid[l] = block.paid[l] + reward;
            put(&mut block.q, l, after.q);
            put(&mut block.v, l, after.v);
            overs[l] = over;
            ended |= over;
        }
        row.write_block(writer, b, &out, records);
        if const { P::DRAWS } {
            *words = drawn;
        }
        ended
    }
}
