//! Studies of batches: speed, memory, rollouts, storage and reproducibility.

pub mod bench;
mod bit_comparison;
mod dataset_error;
mod determinism;
mod measurement;
mod memory;
mod rollout;
mod scaling_regime;
mod source_rollouts;
mod storage;
mod throughput;

pub use determinism::{Determinism, SystemDeterminism};
pub use memory::Memory;
pub use rollout::{Rollout, RolloutSettings};
pub use storage::{Storage, StorageSettings};
pub use throughput::{Rate, Throughput, ThroughputSettings, Wanted, ladder};
