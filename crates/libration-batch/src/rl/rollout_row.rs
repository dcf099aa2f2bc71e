//! Rows of a rollout: one step of neighbouring environments.

use bytemuck::Pod;
use libration_core::Float;

use super::block_output::{BlockOutput, Step};
use super::block_size::LANES;
use super::{Layout, Writes};
use crate::ensemble::instructions::Target;
use crate::ensemble::stream::Streaming;

/// The destination of one step of neighbouring environments.
#[derive(Debug)]
pub(super) struct RolloutRow<'a, T, const O: usize, const D: usize> {
    /// The planes, or all numbers in the first.
    pub(super) observation: [&'a mut [T]; O],
    pub(super) action: [&'a mut [T]; D],
    pub(super) reward: &'a mut [T],
    pub(super) terminated: &'a mut [u8],
    /// Empty without a field of truncations.
    pub(super) truncated: &'a mut [u8],
    pub(super) log_probability: &'a mut [T],
}

/// Buffers for interleaved numbers. A local variable would be split into scalars, and its vectors lost.
#[repr(C, align(64))]
pub(super) struct Records<T, const O: usize, const D: usize> {
    seen: [[T; O]; LANES],
    actions: [[T; D]; LANES],
}

impl<T: Float, const O: usize, const D: usize> Records<T, O, D> {
    pub(super) fn zeros() -> Self {
        Records { seen: [[T::zero(); O]; LANES], actions: [[T::zero(); D]; LANES] }
    }
}

/// The layout and the kind of stores of rows.
pub(super) struct Writer<I: Target> {
    pub(super) streaming: Streaming<I>,
    pub(super) layout: Layout,
    pub(super) writes: Writes,
}

impl<T: Float + Pod, const O: usize, const D: usize> RolloutRow<'_, T, O, D> {
    /// Writes the numbers of the `b`-th block, all of whose lanes are in the row.
    #[inline(always)]
    pub(super) fn write_block<I: Target>(
        &mut self,
        writer: &Writer<I>,
        b: usize,
        step: &Step<T, O, D>,
        records: &mut Records<T, O, D>,
    ) {
        writer.write_numbers(b, &step.seen, &mut records.seen, &mut self.observation);
        writer.write_numbers(b, &step.actions, &mut records.actions, &mut self.action);
        writer.write(b, &step.rewards, self.reward);
        if !self.log_probability.is_empty() {
            writer.write(b, &step.log_probabilities, self.log_probability);
        }
    }

    /// Writes which episodes ended in the `b`-th block.
    #[inline(always)]
    pub(super) fn write_flags<I: Target>(
        &mut self,
        writer: &Writer<I>,
        b: usize,
        overs: &[u8; LANES],
        cuts: &[u8; LANES],
    ) {
        writer.write(b, overs, self.terminated);
        if !self.truncated.is_empty() {
            writer.write(b, cuts, self.truncated);
        }
    }

    /// Writes what a block yielded that begins with the `from`-th environment, and of which only `count` lanes are in the row.
    #[inline(never)]
    pub(super) fn write_part(
        &mut self,
        layout: Layout,
        from: usize,
        count: usize,
        out: &BlockOutput<T, O, D>,
    ) {
        fn numbers<T: Copy, const N: usize>(
            layout: Layout,
            which: [usize; 2],
            planes: &[[T; LANES]; N],
            to: &mut [&mut [T]; N],
        ) {
            for (i, plane) in planes.iter().enumerate() {
                if layout == Layout::Planes {
                    copy(which, plane, to[i]);
                    continue;
                }
                let [from, count] = which;
                let records = to[0].chunks_exact_mut(N).skip(from).take(count);
                records.zip(plane).for_each(|(record, x)| record[i] = *x);
            }
        }
        fn copy<X: Copy>([from, count]: [usize; 2], what: &[X; LANES], to: &mut [X]) {
            let to = to.iter_mut().skip(from).take(count);
            to.zip(what).for_each(|(to, x)| *to = *x);
        }
        let which = [from, count];
        numbers(layout, which, &out.step.seen, &mut self.observation);
        numbers(layout, which, &out.step.actions, &mut self.action);
        copy(which, &out.step.rewards, self.reward);
        copy(which, &out.step.log_probabilities, self.log_probability);
        copy(which, &out.overs, self.terminated);
        copy(which, &out.cuts, self.truncated);
    }
}

impl<I: Target> Writer<I> {
    /// Writes the `at`-th `N` of `to`.
    #[inline(always)]
    fn write<X: Pod, const N: usize>(&self, at: usize, from: &[X; N], to: &mut [X]) {
        let Some(to) = to.as_chunks_mut::<N>().0.get_mut(at) else { return };
        if self.goes_past(to) {
            self.streaming.block(from, to);
        } else {
            *to = *from;
        }
    }

    /// Whether this is to be written past the caches, and can be.
    #[inline(always)]
    fn goes_past<X: Pod, const N: usize>(&self, to: &[X; N]) -> bool {
        self.writes == Writes::Past && self.streaming.takes(to)
    }

    /// Writes several numbers for each of the `b`-th block. Where they are interleaved on their way past the caches, it is in
    /// `records`.
    #[inline(always)]
    fn write_numbers<T: Float + Pod, const N: usize>(
        &self,
        b: usize,
        planes: &[[T; LANES]; N],
        records: &mut [[T; N]; LANES],
        to: &mut [&mut [T]; N],
    ) {
        if const { N <= 1 } || self.layout == Layout::Planes {
            for (plane, to) in planes.iter().zip(to) {
                self.write(b, plane, to);
            }
            return;
        }
        let Some(to) = to[0].as_chunks_mut().0.as_chunks_mut().0.get_mut(b) else { return };
        if self.goes_past(to) {
            interleave(planes, records);
            self.streaming.block(records, to);
        } else {
            interleave(planes, to);
        }
    }
}

/// Numbers of every lane side by side.
#[inline(always)]
pub(super) fn interleave<T: Copy, const N: usize>(
    planes: &[[T; LANES]; N],
    records: &mut [[T; N]; LANES],
) {
    for (l, record) in records.iter_mut().enumerate() {
        for (number, plane) in record.iter_mut().zip(planes) {
            *number = plane[l];
        }
    }
}
