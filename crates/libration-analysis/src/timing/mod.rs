//! Timing of a control loop: the effects of latency and jitter, derived from the shipped step.
//!
//! The plant has one degree of freedom. A command `u = −K_p q − K_d v` is computed from the state at the
//! beginning of a step, arrives later, and is held until the next one arrives.

mod circular_coordinates;
mod cost;
mod delay_polynomial;
mod float_step;
mod hidden_latency;
mod imperfections;
mod jitter_margin;
mod latency;
mod latency_windows;
mod linear_controller;
mod lqr;
mod lyapunov;
mod margin;
mod mean_square;
mod mode;
mod observer;
mod periodic;
mod plant;
mod random_latency;
mod recorded_schedule;
mod resonance;
mod riccati;
#[cfg(test)]
mod sample;
mod skew;
mod stages;
mod switching;
mod zoh_step;

pub use hidden_latency::HiddenLatency;
pub use imperfections::{CostError, Imperfections};
pub use jitter_margin::JitterMargin;
pub use latency_windows::LatencyWindows;
pub use linear_controller::{LinearController, NotLinear};
pub use lqr::{LqrError, Regulator};
pub use mean_square::MeanSquare;
pub use mode::Mode;
pub use observer::ObserverNoise;
pub use plant::Plant;
pub use resonance::{Resonance, StepNoise};
pub use switching::{Switching, SwitchingError};
pub use zoh_step::ZohStep;
