//! Gains of servos: whether they hold at a time step, by which margin, and with which integrator.

mod command_option;
mod conclusion;
mod coupled_step;
mod first_screen;
mod gain_limits;
mod gain_search;
mod growth;
mod held_step;
mod integrator_row;
mod joint_step;
mod limit_in_json;
mod measured;
mod measured_summary;
mod other_forces;
mod page;
mod report;
mod servo_gain;
mod servo_integrator;
mod servo_mode;
mod servo_step;
mod servos;
mod stable_factors;
mod step_units;
mod summary;
mod torque;

pub use integrator_row::IntegratorRow;
pub use measured::{MeasuredGains, ServoRow};
pub use other_forces::OtherForces;
pub use page::gains_page;
pub use report::{GainReport, JointRow, gains};
pub use servo_gain::ServoGain;
pub use servo_integrator::ServoIntegrator;
pub use servo_mode::ServoMode;
pub use servos::{ServoError, Servos, ServosDescription};
pub use torque::Torque;
