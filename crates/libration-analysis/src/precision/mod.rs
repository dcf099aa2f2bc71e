//! Effects of rounding on an orbit: the rounding error of a step, cycles, a clock in floats,
//! and the point at which they exceed the error of the method.

mod clock;
mod cycle;
mod rounding;

pub use clock::float_clock;
pub use cycle::Cycle;
pub use rounding::LocalRounding;
