//! What timing does to a control loop: latency and jitter of its steps, derived from the shipped step.
//!
//! The plant has one degree of freedom. A command `u = −K_p q − K_d v` is computed from the state at the
//! beginning of a step, arrives later, and is held until the next one arrives.

mod circle;
mod cost;
mod dense_matrix;
mod drawn;
mod held_step;
mod hidden_latency;
mod imperfections;
mod jitter;
mod jitter_margin;
mod latency;
mod linear;
mod linear_controller;
mod lqr;
mod lyapunov;
mod margin;
mod mean_square;
mod mode;
mod observer;
mod periodic;
mod plant;
mod quasi;
mod random_latency;
mod replayed;
mod resonance;
mod riccati;
#[cfg(test)]
mod sample;
mod sampled;
mod skew;
mod split;
mod stage;
mod switching;
mod waiting;
mod windows;

pub use held_step::HeldStep;
pub use hidden_latency::HiddenLatency;
pub use imperfections::{CostError, Imperfections};
pub use jitter_margin::JitterMargin;
pub use linear_controller::{LinearController, NotLinear};
pub use lqr::{LqrError, Regulator};
pub use mean_square::MeanSquare;
pub use mode::Mode;
pub use observer::ObserverNoise;
pub use plant::Plant;
pub use resonance::{Resonance, StepNoise};
pub use switching::{Switching, SwitchingError};
pub use windows::Windows;
