//! The state of a block of environments.

use libration_core::Float;

use super::episodes::EpisodeBlock;
use crate::rl::block_size::LANES;

/// A row of a block.
pub(super) type Row<T> = [T; LANES];

/// A block with its positions and velocities and with what is on its way.
pub(super) struct BlockState<'a, T: Float> {
    pub(super) episodes: &'a mut EpisodeBlock<T>,
    /// Positions, then velocities.
    pub(super) states: &'a mut [Row<T>],
    /// The [numbers](ProgramEnvironment::numbers) of the episodes.
    pub(super) numbers: &'a mut [Row<T>],
    pub(super) past: &'a mut [T],
}

/// Row `i` of these one after the other; none behind the last.
pub(super) fn row_of<T, const N: usize>(all: [&[Row<T>]; N], mut i: usize) -> Option<&Row<T>> {
    for rows in all {
        if let Some(row) = rows.get(i) {
            return Some(row);
        }
        i -= rows.len();
    }
    None
}

/// Sets the times since the episodes began, in seconds of an ideal clock.
pub(super) fn set_times<T: Float>(times: &mut Row<T>, now: u64, began: &[u64; LANES], span: f64) {
    for (time, began) in times.iter_mut().zip(began) {
        // Lanes that are no environments have no age.
        *time = T::from_f64(f64::from(now.saturating_sub(*began) as u32) * span);
    }
}
