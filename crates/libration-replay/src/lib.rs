//! Replay buffers: memory of transitions from which a learner draws batches.
//!
//! A [`ReplayBuffer`] stores the last steps of the environments of a [`Rollout`](libration_batch::rl::Rollout), one rollout per insertion. The next
//! observation is in the next row, or stored separately at the end of an episode: each observation is stored once. A [`Batch`] of
//! transitions, of n-step returns, or [`Sequences`] of steps is sampled uniformly or in proportion to priorities. Seed and number of
//! a batch determine the sample. All data lie in one piece of memory, which may be a file. If the process dies, completed
//! insertions are kept.
//!
//! This crate reads no clock and prints nothing; a file in memory is all that it reads and writes.

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
mod rows;
mod sampling;
mod sequences;
mod sum_tree;
mod verification;

pub use batch::{Batch, Columns};
pub use capacity::Capacity;
pub use draw::Draw;
pub use error::ReplayError;
pub use replay_buffer::ReplayBuffer;
pub use sampling::Lookahead;
pub use sequences::Sequences;
pub use sum_tree::SumTree;
