//! What rounding does to an orbit: how much a step rounds, when an orbit repeats itself, where a clock of floats is,
//! and when all that outweighs the error of the method.

mod clock;
mod cycle;
mod rounding;

pub use clock::float_clock;
pub use cycle::Cycle;
pub use rounding::LocalRounding;
