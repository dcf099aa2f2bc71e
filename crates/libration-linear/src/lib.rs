//! Linear plants of any size, and loops around them as matrices.
//!
//! A period of a loop is a matrix on its state: the states of the plant, the memory of the controller, and all commands and
//! measurements in transit. Everything is in `f64`.

mod controller;
mod exponential;
mod held_step;
mod jitter;
mod layout;
mod linear_equations;
mod matrix;
mod period;
mod random_stages;
mod spectral_radius;
mod stage;
mod stein;
mod step_integrals;

pub use controller::DiscreteController;
pub use exponential::exponential;
pub use held_step::HeldStep;
pub use jitter::{Averages, MOST_TURN};
pub use layout::{Layout, Transit};
pub use linear_equations::solve;
pub use matrix::Matrix;
pub use period::{Arrival, Dynamics, Period, SplitStep};
pub use random_stages::RandomStages;
pub use spectral_radius::{is_schur_stable, log_spectral_radius};
pub use stage::{Stage, mean_square};
pub use stein::{solve_stein, symmetric_square};
pub use step_integrals::StepIntegrals;
