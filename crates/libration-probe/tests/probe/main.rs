//! Audits of steps whose properties are known.

mod faults;
mod simulators;
mod theory;
