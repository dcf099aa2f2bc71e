//! Counter-based random numbers: a draw is a function of its address alone.
//!
//! The address of a draw is a seed, a trajectory, a step and a purpose. So the noise of a trajectory depends on neither
//! the number of threads nor the size of the ensemble nor the order of draws, and a run can begin at any
//! step.

mod address;
mod deviate;
mod gaussian_lanes;
mod philox;
mod streams;

pub use address::{Address, Purpose};
pub use deviate::{LARGEST, UNIT, normal, odd, uniform};
pub use gaussian_lanes::gaussian_lanes;
pub use philox::philox4x32;
pub use streams::{EPOCH, Streams};
