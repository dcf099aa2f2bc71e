//! Memory of transitions from which a learner draws batches.
//!
//! A [`Replay`] keeps the last steps of as many environments as a [`Rollout`](crate::rl::Rollout) has, whole rollouts at a time.
//! What is seen next is the next row, or stands apart where an episode ended: no observation is kept twice. A [`Batch`] of
//! transitions, of sums of several rewards, or of [`Sequences`] of steps is drawn uniformly, or in proportion to priorities, by
//! address: from a seed and a number. All of it lies in one piece of memory, which may be a file: at whatever moment a process
//! dies, what was inserted before is found there again.

mod batch;
mod capacity;
mod checkpoint;
mod divide;
mod draw;
mod error;
mod found;
mod insert;
mod memory;
mod power;
mod prioritised;
mod sample;
mod sequences;
mod store;
mod sums;

pub use batch::{Batch, Columns};
pub use capacity::Capacity;
pub use draw::Draw;
pub use error::ReplayError;
pub use sample::Lookahead;
pub use sequences::Sequences;
pub use store::Replay;
pub use sums::SumTree;
