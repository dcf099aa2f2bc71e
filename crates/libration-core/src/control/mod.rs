//! Parts of control loops: clocks, delays, controllers and disturbances.
//!
//! A [`Clock`] gives the lengths of steps, a [`Delay`] the arrival times of commands, a [`Controller`] the commands and a
//! [`Disturbance`] the process noise.
//! `Loops` runs them.

pub mod clock;
pub mod controller;
pub mod delay;
mod disturbance;
pub mod error;
mod feedback;
mod jitter;
mod latency;
mod memory;
mod observer;
mod random_latency;
mod start_address;

pub use clock::Clock;
pub use controller::Controller;
pub use delay::{Delay, Schedule};
pub use disturbance::{Disturbance, NoDisturbance, WhiteNoise};
pub use error::ControlError;
pub use feedback::{Feedback, LqrWeights};
pub use jitter::Jitter;
pub use latency::Latency;
pub use memory::Memory;
pub use observer::StateObserver;
pub use random_latency::{LatencyTableError, RandomLatency};
pub use start_address::StartAddress;
