//! Studies of batches: speed, memory, rollouts, storage, and the same bits everywhere.

pub mod bench;
mod changed;
mod desk;
mod determinism;
mod failure;
mod memory;
mod regime;
mod reported;
mod rollout;
mod storage;
mod throughput;

pub use determinism::Determinism;
pub use memory::Memory;
pub use rollout::{Rollout, RolloutSettings};
pub use storage::{Storage, StorageSettings};
pub use throughput::{Throughput, ThroughputSettings};
