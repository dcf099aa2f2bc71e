//! Analyses and trajectories of a system that is chosen at run time: what the commands `analyze` and `simulate` give.

pub mod analyze;
pub mod export;
pub mod trajectory;
