//! Environments chosen at run time, and data sets of their rollouts.

pub mod dataset;
pub mod environments;
