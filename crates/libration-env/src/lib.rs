//! Environments that are chosen at run time, and the data sets that they fill.

pub mod dataset;
pub mod environments;
