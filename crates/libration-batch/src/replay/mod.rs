//! Replay buffers: memory of transitions from which a learner draws batches.
//!
//! A [`Replay`] keeps the last steps of as many environments as a [`Rollout`](crate::rl::Rollout) has, whole rollouts at a time.
//! What is seen next is the next row, or stands apart where an episode ended: no observation is kept twice. A [`Batch`] of
//! transitions, of sums of several rewards, or of [`Sequences`] of steps is drawn uniformly, or in proportion to priorities, by
//! address: from a seed and a number. All of it lies in one piece of memory, which may be a file: at whatever moment a process
//! dies, what was inserted before is found there again.

mod batch;
mod capacity;
mod checkpoint;
mod divisor;
mod draw;
mod error;
mod insertion;
mod memory;
mod power;
mod prioritised_sampling;
mod replay_buffer;
mod sampling;
mod sequences;
mod sum_tree;
mod verification;

pub use batch::{Batch, Columns};
pub use capacity::Capacity;
pub use draw::Draw;
pub use error::ReplayError;
pub use replay_buffer::Replay;
pub use sampling::Lookahead;
pub use sequences::Sequences;
pub use sum_tree::SumTree;
