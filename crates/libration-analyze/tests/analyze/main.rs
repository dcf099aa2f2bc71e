//! Tests of analyses and trajectories of systems chosen at run time.

#![allow(clippy::unwrap_used)]

mod adaptive;
mod analyze;
mod comparison;
mod dimensions;
mod energy_growth;
mod exact_growth;
mod export;
mod growing_motions;
mod implicit;
mod linear_analysis;
mod loop_growth;
mod operating_points;
mod overflow;
mod reference;
mod reference_flow;
mod requests;
mod stability_windows;
mod temperature;
#[path = "../../src/trajectory/three_digits.rs"]
mod three_digits;
mod trajectory;
