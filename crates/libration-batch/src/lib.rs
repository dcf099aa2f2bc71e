//! Batches of trajectories, control loops and environments.
//!
//! Kernels are compiled for each instruction set. The bits depend on neither the instruction set nor the number of threads.
//!
//! This crate does no input or output, reads no clock and prints nothing.

pub mod checkpoint;
pub mod ensemble;
// No unit test needs it.
#[cfg(not(test))]
mod column_program;
#[cfg(not(test))]
mod machine;
pub mod rl;
#[cfg(not(test))]
mod trajectory;

#[cfg(not(test))]
pub use column_program::{ColumnProgram, Columns};
pub use ensemble::Ensemble;
#[cfg(not(test))]
pub use trajectory::{Trajectory, TrajectoryProgram};
