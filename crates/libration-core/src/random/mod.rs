//! Counter-based random numbers: a draw is a function of its address alone.
//!
//! A draw is a function of a seed, a trajectory, a step and a purpose. So the noise of a trajectory depends on neither
//! the number of threads nor the size of the ensemble nor the order in which anything is asked, and a run
//! can begin anywhere.

mod address;
mod deviate;
mod philox;
mod streams;

pub use address::{Address, Purpose};
pub use deviate::{LARGEST, UNIT, normal, odd, uniform};
pub use philox::philox4x32;
pub use streams::{EPOCH, Streams};
