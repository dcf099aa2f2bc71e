//! A thread's share of the loops, for the whole horizon.

use core::marker::PhantomData;
use core::ops::Range;

use bytemuck::Pod;
use libration_core::control::{Clock, Controller, Delay, Disturbance, Memory};
use libration_core::{Float, Integrator, System};

use super::generators::Generators;
use super::kernel::{Common, Steps};
use super::rows::Rows;
use crate::ensemble::instructions::{Baseline, Target, Targeted};
use crate::ensemble::planes::Share;
use crate::ensemble::run::{Observe, widest};
use crate::ensemble::{Assign, Observer};

/// The steps of the loops of a share.
pub(super) struct Run<'a, 's, T, A, M, K, C, L, N, Sys, O, const D: usize> {
    pub(super) common: &'s Common<'s, T, A, M, K, C, L, N>,
    pub(super) share: Share<'a, T, D>,
    pub(super) rows: Rows<'a, T>,
    pub(super) steps: Range<u64>,
    /// The observer and its interval in steps, if there is one.
    pub(super) watch: Option<(u64, &'a mut O)>,
    pub(super) system: PhantomData<Sys>,
}

/// Widths of a block, in lanes: divisors of the pieces that the memory comes in.
const WIDTHS: [usize; 6] = [8, 16, 32, 64, 128, 192];

/// Lanes of a block that has so many rows: what fits in the registers, but enough to hide latencies.
const fn width<I: Target, T>(rows: usize) -> usize {
    let fit = (if I::REGISTERS >= 32 { 26 } else { 24 }) / rows;
    widest::<I, T>(if fit < 2 { 2 } else { fit }, &WIDTHS)
}

impl<T, A, M, K, C, L, N, Sys, O, const D: usize> Targeted
    for Run<'_, '_, T, A, M, K, C, L, N, Sys, O, D>
where
    T: Float + Pod,
    A: Assign<Sys>,
    M: Integrator,
    K: Controller<T, D>,
    C: Clock<T>,
    L: Delay<T>,
    N: Disturbance,
    Sys: System<T, D>,
    O: Observer<T, D>,
{
    const BASELINE_ONLY: bool = Sys::BASELINE_ONLY || M::BASELINE_ONLY;

    type Output = ();

    fn on<I: Target>(self, target: I) {
        // Of these arms the compiler keeps one; of ranges it would keep all.
        match const { width::<I, T>(Self::ROWS) } {
            8 => self.blocks::<I, 8>(target),
            16 => self.blocks::<I, 16>(target),
            32 => self.blocks::<I, 32>(target),
            64 => self.blocks::<I, 64>(target),
            128 => self.blocks::<I, 128>(target),
            _ => self.blocks::<I, 192>(target),
        }
    }
}

impl<'a, T, A, M, K, C, L, N, Sys, O, const D: usize> Run<'a, '_, T, A, M, K, C, L, N, Sys, O, D>
where
    T: Float + Pod,
    A: Assign<Sys>,
    M: Integrator,
    K: Controller<T, D>,
    C: Clock<T>,
    L: Delay<T>,
    N: Disturbance,
    Sys: System<T, D>,
    O: Observer<T, D>,
{
    /// Rows of a block that change in every step.
    const ROWS: usize = {
        let held = if K::ACTS { D } else { 0 };
        let streams = if C::DRAWS { 2 } else { 0 };
        let pushed = if N::ACTS { 2 + D } else { 0 };
        2 * D + held + streams + pushed + C::Memory::LEN + K::Memory::LEN + L::Memory::LEN
    };

    /// Block after block, each from the first step to the last.
    fn blocks<I: Target, const W: usize>(mut self, target: I) {
        let first = self.share.first;
        while self.share.len() > 1 {
            let block = self.share.split_off(W);
            self.block::<I, W>(target, first, block);
        }
        if self.share.len() == 1 {
            // A lone one has no vectors: one kernel serves all instruction sets.
            let block = self.share.split_off(1);
            self.block::<Baseline, 1>(Baseline, first, block);
        }
    }

    fn block<I: Target, const W: usize>(
        &mut self,
        target: I,
        first: usize,
        block: Share<'a, T, D>,
    ) {
        let mut block = block;
        let systems = self.common.setup.systems.lanes::<W>(block.first, block.len());
        let mut generators = Generators::new();
        let mut step = self.steps.start;
        if let Some((_, observer)) = &mut self.watch
            && step == 0
        {
            target.run(Observe { observer: *observer, lanes: block.lanes(step) });
        }
        while step < self.steps.end {
            let next = match self.watch {
                Some((every, _)) => (step - step % every).saturating_add(every).min(self.steps.end),
                None => self.steps.end,
            };
            let (common, block, generators) = (self.common, &mut block, &mut generators);
            let memory = self.rows.of::<W>(block.first - first);
            let steps = step..next;
            if const { K::ACTS && L::SHARED }
                && common.setup.delay.schedule().whole_steps().is_some()
            {
                target.run(Steps::<T, A, M, K, C, L, N, Sys, D, W, true> {
                    common,
                    block,
                    memory,
                    generators,
                    systems,
                    steps,
                });
            } else {
                target.run(Steps::<T, A, M, K, C, L, N, Sys, D, W, false> {
                    common,
                    block,
                    memory,
                    generators,
                    systems,
                    steps,
                });
            }
            step = next;
            if let Some((every, observer)) = &mut self.watch
                && step.is_multiple_of(*every)
            {
                target.run(Observe { observer: *observer, lanes: block.lanes(step) });
            }
        }
    }
}
