//! The destination of transitions.

use libration_core::Float;
use ndarray::{ArrayViewMut2, ArrayViewMut3, Axis};

use super::block_state::Row;
use super::block_step::BlockStep;
use crate::rl::block_size::LANES;

/// The destination of transitions of neighbouring environments: `[t, n]`, or `[t, n, i]`. What is not requested has no columns.
pub(super) struct Transitions<'a, T> {
    pub(super) observation: ArrayViewMut3<'a, T>,
    pub(super) action: ArrayViewMut3<'a, T>,
    pub(super) reward: ArrayViewMut2<'a, T>,
    pub(super) terminated: ArrayViewMut2<'a, u8>,
    pub(super) truncated: ArrayViewMut2<'a, u8>,
    pub(super) log_probability: ArrayViewMut2<'a, T>,
}

impl<'a, T: Float> Transitions<'a, T> {
    /// Takes off the first `count` environments.
    pub(super) fn split_off(self, count: usize) -> (Self, Self) {
        fn flags<X>(all: ArrayViewMut2<'_, X>, count: usize) -> [ArrayViewMut2<'_, X>; 2] {
            let count = count.min(all.ncols());
            all.split_at(Axis(1), count).into()
        }
        fn numbers<X>(all: ArrayViewMut3<'_, X>, count: usize) -> [ArrayViewMut3<'_, X>; 2] {
            let count = count.min(all.dim().1);
            all.split_at(Axis(1), count).into()
        }
        let [observation, observations] = numbers(self.observation, count);
        let [action, actions] = numbers(self.action, count);
        let [reward, rewards] = flags(self.reward, count);
        let [terminated, terminations] = flags(self.terminated, count);
        let [truncated, truncations] = flags(self.truncated, count);
        let [log_probability, log_probabilities] = flags(self.log_probability, count);
        let head =
            Transitions { observation, action, reward, terminated, truncated, log_probability };
        let tail = Transitions {
            observation: observations,
            action: actions,
            reward: rewards,
            terminated: terminations,
            truncated: truncations,
            log_probability: log_probabilities,
        };
        (head, tail)
    }

    /// Writes step `t` of `count` environments from the `first` on.
    pub(super) fn write(
        &mut self,
        t: usize,
        first: usize,
        count: usize,
        work: &BlockStep<T>,
        cuts: &[u8; LANES],
    ) {
        fn row<X: Copy>(to: &mut ArrayViewMut2<'_, X>, [t, first, count]: [usize; 3], from: &[X]) {
            // Neighbours lie side by side.
            if let Some(row) = to.index_axis_mut(Axis(0), t).into_slice().filter(|r| !r.is_empty())
            {
                row[first..first + count].copy_from_slice(&from[..count]);
            }
        }
        fn rows<X: Copy>(
            to: &mut ArrayViewMut3<'_, X>,
            [t, first, count]: [usize; 3],
            from: &[Row<X>],
        ) {
            if to.is_empty() {
                return;
            }
            let mut step = to.index_axis_mut(Axis(0), t);
            match step.as_slice_mut() {
                Some(records) => {
                    let records = &mut records[first * from.len()..][..count * from.len()];
                    interleave(from, records);
                }
                // One plane after the other.
                None => {
                    for (column, from) in step.columns_mut().into_iter().zip(from) {
                        if let Some(plane) = column.into_slice() {
                            plane[first..first + count].copy_from_slice(&from[..count]);
                        }
                    }
                }
            }
        }
        let place = [t, first, count];
        rows(&mut self.observation, place, &work.seen);
        rows(&mut self.action, place, &work.actions);
        row(&mut self.reward, place, &work.rewards);
        row(&mut self.terminated, place, &work.overs);
        row(&mut self.truncated, place, cuts);
        row(&mut self.log_probability, place, &work.log_probabilities);
    }
}

/// Writes the numbers of each lane side by side, for as many lanes as there is room.
pub(super) fn interleave<X: Copy>(rows: &[Row<X>], records: &mut [X]) {
    /// With a number of rows that the compiler knows.
    fn known<X: Copy, const N: usize>(rows: &[Row<X>], records: &mut [X]) {
        let (Ok(rows), (records, _)) =
            (<&[Row<X>; N]>::try_from(rows), records.as_chunks_mut::<N>())
        else {
            return;
        };
        for (l, record) in records.iter_mut().enumerate().take(LANES) {
            *record = core::array::from_fn(|i| rows[i][l]);
        }
    }
    match rows.len() {
        1 => records.copy_from_slice(&rows[0][..records.len()]),
        2 => known::<X, 2>(rows, records),
        3 => known::<X, 3>(rows, records),
        4 => known::<X, 4>(rows, records),
        count => {
            for (i, row) in rows.iter().enumerate() {
                let numbers = records.iter_mut().skip(i).step_by(count);
                numbers.zip(row).for_each(|(number, &x)| *number = x);
            }
        }
    }
}
