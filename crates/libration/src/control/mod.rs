//! Loops that are not ideal: clocks that are not exact, commands that arrive late, and what commands.
//!
//! A [`Clock`] tells how long steps are, a [`Delay`] when commands arrive, a [`Controller`] computes them, a [`Disturbance`] is
//! what nobody commands.
//! [`Loops`](crate::ensemble::Loops) runs them.

mod begin;
pub mod clock;
pub mod controller;
pub mod delay;
mod disturbance;
pub(crate) mod error;
mod memory;

pub use begin::Begin;
pub use clock::Clock;
pub use controller::Controller;
pub use delay::{Delay, Schedule};
pub use disturbance::{Disturbance, Undisturbed, WhiteNoise};
pub use error::ControlError;
pub use memory::Memory;
