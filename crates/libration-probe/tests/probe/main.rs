//! Audits of steps whose properties are known.

#![allow(clippy::unwrap_used)]

mod faults;
mod gains;
mod memory;
mod pages;
mod simulators;
mod theory;
