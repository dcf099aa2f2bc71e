//! Batches of trajectories, control loops and environments.
//!
//! Kernels are compiled for each instruction set. The bits depend on neither the instruction set nor the number of threads.
//!
//! This crate does no input or output, reads no clock and prints nothing.

pub mod checkpoint;
pub mod ensemble;
// No unit test needs it.
#[cfg(not(test))]
mod machine;
pub mod replay;
pub mod rl;

pub use ensemble::Ensemble;
