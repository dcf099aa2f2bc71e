//! A thread's share of the trajectories, for the whole horizon.

use core::ops::Range;

use libration_core::{Float, Integrator, System};
use pulp::{Simd, WithSimd};

use super::assign::Assign;
use super::instructions::{Baseline, Target, Targeted};
use super::kernel::{Advance, Pass};
use super::planes::Share;
use super::{Lanes, Observer};

/// The steps of the trajectories of a share.
pub(super) struct Run<'a, T, M, A, C, Sys, O, const D: usize> {
    pub(super) share: Share<'a, T, D>,
    pub(super) method: M,
    pub(super) systems: A,
    pub(super) dt: C,
    /// Steps taken before and after.
    pub(super) steps: Range<u64>,
    /// The observer and its interval in steps, if there is one.
    pub(super) watch: Option<(u64, &'a mut O)>,
    pub(super) system: core::marker::PhantomData<(T, Sys)>,
}

/// Widths of a block, in lanes.
const WIDTHS: [usize; 10] = [8, 16, 24, 32, 48, 64, 96, 128, 160, 208];

/// Vectors that are enough to hide the latency of a step in which operations do not all wait for each
/// other, and to keep the memory busy.
const FEW: usize = 4;

/// Steps of a pass up to which the memory is the limit.
const SHORT: u64 = 2;

/// The width of the blocks in which a kernel runs fastest, as measured.
///
/// Wide enough that the latency of one lane's arithmetic is hidden behind the others. With 32
/// registers the planes of a block fill those that the step leaves, with 16 they live in the nearest
/// cache.
const fn width<I: Target, T, const D: usize>(carries: bool, taken: usize) -> usize {
    let (planes, registers) = match (carries, I::REGISTERS >= 32) {
        (false, true) => (2 * D, I::REGISTERS.saturating_sub(taken)),
        (true, true) => (3 * D, I::REGISTERS.saturating_sub(taken)),
        (false, false) => (2 * D, 48),
        (true, false) => (3 * D, 40),
    };
    let vectors = registers / planes;
    // Where there are several dimensions, they are as good as several blocks.
    let least = (2 * FEW).div_ceil(if D > 2 { D } else { 2 });
    widest::<I, T>(if vectors > least { vectors } else { least }, &WIDTHS)
}

/// The widest block of at most `vectors` vectors.
pub(super) const fn widest<I: Target, T>(vectors: usize, widths: &[usize]) -> usize {
    let lanes = vectors * I::BYTES / size_of::<T>();
    let mut i = widths.len() - 1;
    while i > 0 && widths[i] > lanes {
        i -= 1;
    }
    widths[i]
}

impl<T, M, A, C, Sys, O, const D: usize> Targeted for Run<'_, T, M, A, C, Sys, O, D>
where
    T: Float,
    M: Integrator,
    A: Assign<Sys>,
    C: Assign<T>,
    Sys: System<T, D>,
    O: Observer<T, D>,
{
    const BASELINE_ONLY: bool = Sys::BASELINE_ONLY || M::BASELINE_ONLY;

    type Output = ();

    fn on<I: Target>(self, target: I) {
        // Of these arms the compiler keeps one.
        match const { width::<I, T, D>(M::CARRIES && Sys::POSITIONAL, M::REGISTERS + Sys::REGISTERS) }
        {
            8 => self.wide::<I, 8>(target),
            16 => self.wide::<I, 16>(target),
            24 => self.wide::<I, 24>(target),
            32 => self.wide::<I, 32>(target),
            48 => self.wide::<I, 48>(target),
            64 => self.wide::<I, 64>(target),
            96 => self.wide::<I, 96>(target),
            128 => self.wide::<I, 128>(target),
            160 => self.wide::<I, 160>(target),
            _ => self.wide::<I, 208>(target),
        }
    }
}

impl<T, M, A, C, Sys, O, const D: usize> Run<'_, T, M, A, C, Sys, O, D>
where
    T: Float,
    M: Integrator,
    A: Assign<Sys>,
    C: Assign<T>,
    Sys: System<T, D>,
    O: Observer<T, D>,
{
    fn wide<I: Target, const W: usize>(self, target: I) {
        // As above.
        match const { widest::<I, T>(FEW, &WIDTHS) } {
            8 => self.blocks::<I, W, 8>(target),
            16 => self.blocks::<I, W, 16>(target),
            32 => self.blocks::<I, W, 32>(target),
            _ => self.blocks::<I, W, 64>(target),
        }
    }

    /// Block after block, each from the first step to the last.
    fn blocks<I: Target, const W: usize, const NARROW: usize>(mut self, target: I) {
        let steps = self.steps.end - self.steps.start;
        // Where somebody watches, no such kernel is made.
        if const { !O::WATCHES } && steps <= SHORT {
            let share = self.share.split_off(self.share.len() / NARROW * NARROW);
            let (method, systems, dt) = (self.method, self.systems, self.dt);
            target.run(Pass::<T, M, A, C, Sys, D, NARROW> {
                share,
                method,
                systems,
                dt,
                steps,
                system: core::marker::PhantomData,
            });
        }
        while self.share.len() > 1 {
            let block = self.share.split_off(W);
            self.block::<I, W>(target, block);
        }
        if self.share.len() == 1 {
            // A lone one has no vectors: one kernel serves all instruction sets.
            let block = self.share.split_off(1);
            self.block::<Baseline, 1>(Baseline, block);
        }
    }

    fn block<I: Target, const W: usize>(&mut self, target: I, mut block: Share<'_, T, D>) {
        let (method, first, count) = (self.method, block.first, block.len());
        let systems = self.systems.lanes::<W>(first, count);
        let dt = self.dt.lanes::<W>(first, count);
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
            let steps = next - step;
            target.run(Advance::<T, M, A, C, Sys, D, W> {
                block: &mut block,
                method,
                systems,
                dt,
                steps,
            });
            step = next;
            if let Some((every, observer)) = &mut self.watch
                && step.is_multiple_of(*every)
            {
                target.run(Observe { observer: *observer, lanes: block.lanes(step) });
            }
        }
    }
}

/// A call of the observer for a block, compiled for the instruction set.
pub(super) struct Observe<'o, 'l, T, O, const D: usize> {
    pub(super) observer: &'o mut O,
    pub(super) lanes: Lanes<'l, T, D>,
}

impl<T, O: Observer<T, D>, const D: usize> WithSimd for Observe<'_, '_, T, O, D> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.observer.observe(&self.lanes);
    }
}
