//! Linear plants of any size, and loops around them as matrices.
//!
//! A period of a loop is a matrix on its state: the states of the plant, the memory of the controller, and all commands and
//! measurements in transit. Everything is in `f64`.

mod channel_part;
mod controller;
mod design;
mod dynamics;
mod eigenvalues;
mod eigenvector;
mod exponential;
mod held_step;
mod jitter;
mod layout;
mod linear_equations;
mod linear_loop;
mod linear_loop_error;
mod loop_layout;
mod loop_mode;
mod loop_timing;
mod matrix;
mod period;
mod plant;
mod plant_modes;
mod plant_rate;
mod random_stages;
mod recorded_loop;
mod recorded_schedule;
mod redesign;
mod riccati;
mod simulation;
mod spectral_radius;
mod stability_margins;
mod stage;
mod stationary;
mod stein;
mod step_integrals;
mod transfer_function;

pub use channel_part::{ChannelPart, ChannelPartError};
pub use controller::DiscreteController;
pub use design::{CostWeights, DesignError};
pub use dynamics::{Dynamics, SplitStep};
pub use eigenvalues::eigenvalues;
pub use eigenvector::eigenvector;
pub use exponential::exponential;
pub use held_step::HeldStep;
pub use jitter::{Averages, MOST_TURN};
pub use layout::{Layout, Transit};
pub use linear_equations::{solve, solve_matrix};
pub use linear_loop::LinearLoop;
pub use linear_loop_error::LinearLoopError;
pub use loop_mode::LoopMode;
pub use loop_timing::{LoopTiming, MissingCommand};
pub use matrix::Matrix;
pub use period::{Arrival, Period};
pub use plant::{LinearPlant, MOST_STATES, PlantError, Signal};
pub use plant_modes::PlantMode;
pub use random_stages::RandomStages;
pub use recorded_schedule::RecordedSchedule;
pub use riccati::{RegulatorProblem, RegulatorSolution};
pub use simulation::Simulation;
pub use spectral_radius::{is_schur_stable, log_spectral_radius};
pub use stability_margins::StabilityMargins;
pub use stage::{Stage, mean_square};
pub use stationary::Stationary;
pub use stein::{solve_stein, symmetric_square};
pub use step_integrals::StepIntegrals;
