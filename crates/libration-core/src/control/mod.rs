//! Loops that are not ideal: clocks that are not exact, commands that arrive late, and what commands.
//!
//! A [`Clock`] tells how long steps are, a [`Delay`] when commands arrive, a [`Controller`] computes them, a [`Disturbance`] is
//! what nobody commands.
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
