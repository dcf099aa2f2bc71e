//! Motions with adaptive steps that stay reversible: the output of `libration simulate --adaptive`.

mod adaptive_programs;
mod adaptive_stepper;
mod adaptive_trajectory;
mod step_control;

pub use adaptive_programs::AdaptivePrograms;
pub use adaptive_stepper::{AdaptiveFailure, AdaptiveStepper};
pub use adaptive_trajectory::{AdaptiveRequest, simulate_until, write};
pub use step_control::StepControl;
