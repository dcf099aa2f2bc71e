//! Tests of analyses and trajectories of systems chosen at run time.

#![allow(clippy::unwrap_used)]

mod analyze;
mod dimensions;
mod export;
mod implicit;
mod linear_analysis;
mod loop_growth;
mod overflow;
mod reference;
mod stability_windows;
mod trajectory;
