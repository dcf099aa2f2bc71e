//! Number types: swap the number, and a step becomes another instrument.

mod float;
mod half;
