//! Audits of steps whose properties are known.

mod faults;
mod gains;
mod simulators;
mod theory;
