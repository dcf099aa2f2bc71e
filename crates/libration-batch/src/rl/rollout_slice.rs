//! Slices of a rollout: neighbouring environments over all steps.

use core::array::from_fn;
use core::mem::replace;
use core::ops::Range;

use ndarray::{ArrayViewMut2, Axis};

use super::Layout;
use super::rollout_row::RolloutRow;

/// The destination of all steps of neighbouring environments. Splitting and reading it allocates nothing: for a short rollout a
/// list of its rows took as long as the steps.
pub(super) struct RolloutSlice<'a, T, const O: usize, const D: usize> {
    /// The planes, or all numbers in the first.
    pub(super) observation: [ArrayViewMut2<'a, T>; O],
    pub(super) action: [ArrayViewMut2<'a, T>; D],
    pub(super) reward: ArrayViewMut2<'a, T>,
    pub(super) terminated: ArrayViewMut2<'a, u8>,
    /// Without columns if the field is absent.
    pub(super) truncated: ArrayViewMut2<'a, u8>,
    pub(super) log_probability: ArrayViewMut2<'a, T>,
    /// The observations after the last step, interleaved in one row.
    pub(super) next: ArrayViewMut2<'a, T>,
    pub(super) layout: Layout,
}

impl<'a, T, const O: usize, const D: usize> RolloutSlice<'a, T, O, D> {
    /// Takes off the first `count` environments.
    pub(super) fn split_off(&mut self, count: usize) -> RolloutSlice<'a, T, O, D> {
        let layout = self.layout;
        let width = |n| if layout == Layout::Interleaved { n } else { 1 };
        RolloutSlice {
            observation: self
                .observation
                .each_mut()
                .map(|all| first_columns(all, count * width(O))),
            action: self.action.each_mut().map(|all| first_columns(all, count * width(D))),
            reward: first_columns(&mut self.reward, count),
            terminated: first_columns(&mut self.terminated, count),
            truncated: first_columns(&mut self.truncated, count),
            log_probability: first_columns(&mut self.log_probability, count),
            next: first_columns(&mut self.next, count * O),
            layout,
        }
    }

    /// The number of steps.
    pub(super) fn steps(&self) -> usize {
        self.reward.nrows()
    }

    /// The observations after the last step; empty if they are not requested.
    pub(super) fn next(&mut self) -> &mut [T] {
        if self.next.is_empty() { &mut [] } else { row(&mut self.next, 0) }
    }

    /// Whether the observations before each step are requested.
    pub(super) fn has_observations(&self) -> bool {
        self.observation.iter().any(|plane| !plane.is_empty())
    }

    /// Step `t`.
    pub(super) fn row(&mut self, t: usize) -> RolloutRow<'_, T, O, D> {
        RolloutRow {
            observation: self.observation.each_mut().map(|all| row(all, t)),
            action: self.action.each_mut().map(|all| row(all, t)),
            reward: row(&mut self.reward, t),
            terminated: row(&mut self.terminated, t),
            truncated: row(&mut self.truncated, t),
            log_probability: row(&mut self.log_probability, t),
        }
    }
}

/// The `N` planes of a tensor, each as so many rows; where its numbers lie side by side there is one, and its rows are longer.
pub(super) fn planes<T, const N: usize>(
    numbers: &mut [T],
    layout: Layout,
    rows: usize,
) -> [ArrayViewMut2<'_, T>; N] {
    let plane = match layout {
        Layout::Interleaved => numbers.len(),
        Layout::Planes => numbers.len() / N.max(1),
    };
    let mut planes = numbers.chunks_exact_mut(plane.max(1));
    from_fn(|_| rows_of(planes.next().unwrap_or_default(), rows))
}

/// A view of `numbers` as `rows` rows.
pub(super) fn rows_of<T>(numbers: &mut [T], rows: usize) -> ArrayViewMut2<'_, T> {
    let width = numbers.len().checked_div(rows).unwrap_or(0);
    ArrayViewMut2::from_shape((rows, width), numbers).expect("whole rows")
}

/// A range of the rows.
pub(super) fn some_rows<'a, X>(
    all: ArrayViewMut2<'a, X>,
    rows: &Range<usize>,
) -> ArrayViewMut2<'a, X> {
    let (_, rest) = all.split_at(Axis(0), rows.start);
    rest.split_at(Axis(0), rows.len()).0
}

/// RolloutRow `t` of columns.
pub(super) fn row<'r, X>(columns: &'r mut ArrayViewMut2<'_, X>, t: usize) -> &'r mut [X] {
    columns.index_axis_mut(Axis(0), t).into_slice().unwrap_or_default()
}

/// Takes off the first `count` columns, or all if there are fewer.
pub(super) fn first_columns<'a, X>(
    columns: &mut ArrayViewMut2<'a, X>,
    count: usize,
) -> ArrayViewMut2<'a, X> {
    let none = rows_of(&mut [], 0);
    let whole = replace(columns, none);
    let count = count.min(whole.ncols());
    let (head, tail) = whole.split_at(Axis(1), count);
    *columns = tail;
    head
}

/// Takes off the first `count`, or all if there are fewer.
pub(super) fn first_of<'a, X>(slice: &mut &'a mut [X], count: usize) -> &'a mut [X] {
    slice.split_off_mut(..count.min(slice.len())).unwrap_or_default()
}
