//! Audits of steps whose properties are known.

#![allow(clippy::unwrap_used)]

use libration_probe::Rates;

mod child_start;
#[path = "../../src/gains/command_option.rs"]
mod command_option;
#[path = "../../src/decay.rs"]
mod decay;
mod energy_losses;
mod faults;
mod finding_kinds;
mod first_difference;
mod gain_pages;
mod gains;
mod gains_beside_limits;
mod inner_steps;
mod jacobians;
mod measured_gains;
mod memory;
mod neutral;
#[path = "../../src/noise_free_matrix.rs"]
mod noise_free_matrix;
mod observations;
mod operating_points;
mod other_forces;
mod pages;
#[path = "../../src/rate_ranges.rs"]
mod rate_ranges;
#[path = "../../src/settled_order.rs"]
mod settled_order;
#[path = "../../src/shorter_step.rs"]
mod shorter_step;
mod simulators;
mod theory;
mod verdicts;
