//! Studies of control loops: latency, jitter, clocks and hierarchies.

mod asynchrony;
mod hierarchy;
mod jitter;
mod latency;
mod loop_ensemble;
mod sample;

pub use asynchrony::Asynchrony;
pub use hierarchy::Hierarchy;
pub use jitter::{Jitter, JitterSettings};
pub use latency::Latency;
