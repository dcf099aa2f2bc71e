//! Many trajectories, control loops and environments at once.
//!
//! Kernels are compiled for each instruction set, and give the same bits on all of them, whatever the number of threads.
//!
//! This crate does no input or output, reads no clock and prints nothing.

pub mod checkpoint;
pub mod ensemble;
pub mod replay;
pub mod rl;

pub use ensemble::Ensemble;
