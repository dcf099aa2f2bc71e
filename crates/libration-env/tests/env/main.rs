//! Data sets of rollouts.

#![allow(clippy::unwrap_used)]

mod dataset;
mod programs;
mod resume;
mod settings;
