//! What timing does to a control loop: latency and jitter of its steps, derived from the shipped step.
//!
//! The plant has one degree of freedom. A command `u = −K_p q − K_d v` is computed from the state at the
//! beginning of a step, arrives later, and is held until the next one arrives.

mod held_step;
mod jitter;
mod latency;
mod lyapunov;
mod margin;
mod plant;
mod quasi;
mod random_latency;
mod skew;
mod windows;

pub use held_step::HeldStep;
pub use jitter::{Jitter, MeanSquare};
pub use latency::Latency;
pub use plant::{Feedback, Plant};
pub use random_latency::{LatencyTableError, RandomLatency};
pub use windows::Windows;
