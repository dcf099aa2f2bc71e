//! A step of neighbouring environments in a rollout.

use core::mem::take;

use bytemuck::Pod;

use super::kernel::LANES;
use super::yields::Yield;
use super::{Layout, Writes};
use crate::Float;
use crate::ensemble::instructions::Target;
use crate::ensemble::kernel::Lines;
use crate::ensemble::stream::Streaming;

/// Where a step of neighbouring environments is written.
#[derive(Debug)]
pub(super) struct Row<'a, T, const O: usize, const D: usize> {
    /// The planes, or all numbers in the first.
    pub(super) observation: [&'a mut [T]; O],
    pub(super) action: [&'a mut [T]; D],
    pub(super) reward: &'a mut [T],
    pub(super) terminated: &'a mut [u8],
    /// Empty where nobody asked for it, as the next.
    pub(super) truncated: &'a mut [u8],
    pub(super) log_probability: &'a mut [T],
}

/// How rows are written.
pub(super) struct Writer<I: Target> {
    pub(super) streaming: Streaming<I>,
    pub(super) layout: Layout,
    pub(super) writes: Writes,
}

static NO_FLAGS: Lines<[u8; LANES]> = Lines([0; LANES]);

impl<'a, T, const O: usize, const D: usize> Row<'a, T, O, D> {
    /// Takes off the first `count` environments.
    pub(super) fn split_off(&mut self, count: usize, layout: Layout) -> Row<'a, T, O, D> {
        let width = |n| if layout == Layout::Interleaved { n } else { 1 };
        Row {
            observation: self.observation.each_mut().map(|plane| first_of(plane, count * width(O))),
            action: self.action.each_mut().map(|plane| first_of(plane, count * width(D))),
            reward: first_of(&mut self.reward, count),
            terminated: first_of(&mut self.terminated, count),
            truncated: first_of(&mut self.truncated, count),
            log_probability: first_of(&mut self.log_probability, count),
        }
    }
}

impl<T: Float + Pod, const O: usize, const D: usize> Row<'_, T, O, D> {
    /// Writes what a block yielded: of `count` environments from the `from`-th of the row on, which is a multiple of
    /// [`LANES`]. Where no episode ends in it there are no flags.
    #[inline(always)]
    pub(super) fn write<I: Target>(
        &mut self,
        writer: &Writer<I>,
        from: usize,
        count: usize,
        whole: bool,
        out: &Yield<T, O, D>,
    ) {
        let Writer { streaming, layout, writes } = writer;
        // Each arm has its own copy of what it writes: one that is named elsewhere would be kept in memory.
        macro_rules! write {
            ($from:expr, $to:expr) => {{
                let full = $to.as_chunks_mut::<LANES>().0.get_mut(from / LANES);
                match (full, writes) {
                    (Some(to), Writes::Plain) => *to = $from,
                    (Some(to), Writes::Past) if streaming.takes(to) => streaming.block(&$from, to),
                    _ => $to[from..][..count].copy_from_slice(&$from[..count]),
                }
            }};
        }
        macro_rules! write_numbers {
            ($from:expr, $to:expr, $n:ident) => {{
                if *layout == Layout::Interleaved && const { $n > 1 } {
                    if let Some(all) = $to.first_mut() {
                        let all = all.as_chunks_mut::<$n>().0;
                        write!(interleaved(&$from), all);
                    }
                } else {
                    for i in 0..$n {
                        write!($from[i], $to[i]);
                    }
                }
            }};
        }
        write_numbers!(out.seen, self.observation, O);
        write_numbers!(out.actions, self.action, D);
        write!(out.rewards, self.reward);
        if !self.log_probability.is_empty() {
            write!(out.log_probabilities, self.log_probability);
        }
        if whole {
            write!(NO_FLAGS.0, self.terminated);
            if !self.truncated.is_empty() {
                write!(NO_FLAGS.0, self.truncated);
            }
        } else {
            // What was written just now in pieces cannot be forwarded as a whole: this waits, but it is rare.
            write!(out.overs, self.terminated);
            if !self.truncated.is_empty() {
                write!(out.cuts, self.truncated);
            }
        }
    }
}

/// Numbers of every lane side by side.
#[inline(always)]
fn interleaved<T: Float + Pod, const N: usize>(planes: &[[T; LANES]; N]) -> [[T; N]; LANES] {
    let mut records = Lines([[T::zero(); N]; LANES]);
    let flat = records.0.as_flattened_mut();
    for l in 0..LANES {
        for i in 0..N {
            flat[l * N + i] = planes[i][l];
        }
    }
    records.0
}

/// Takes off the first `count`, or all if there are fewer.
pub(super) fn first_of<'a, X>(slice: &mut &'a mut [X], count: usize) -> &'a mut [X] {
    let whole = take(slice);
    let (head, tail) = whole.split_at_mut(count.min(whole.len()));
    *slice = tail;
    head
}
