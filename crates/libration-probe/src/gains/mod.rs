//! Gains of servos: whether they hold at a time step, by which margin, and with which integrator.

mod command_option;
mod first_screen;
mod page;
mod report;
mod servo_integrator;
mod servo_mode;
mod servos;
mod stable_factors;

pub use page::gains_page;
pub use report::{GainReport, IntegratorRow, JointRow, gains};
pub use servo_integrator::ServoIntegrator;
pub use servo_mode::ServoMode;
pub use servos::{ServoError, Servos, ServosDescription};
