//! Number types: floats, dual numbers, polynomials, their quotients, exact fractions and wide floats.

mod bits;
mod compensated;
mod conversion;
mod dual;
mod float;
mod half;
mod mantissa;
mod pair;
mod poly;
mod ratio;
mod rational_function;
mod twofloat;
mod wide;

pub use compensated::Compensated;
pub use dual::Dual;
pub use mantissa::Mantissa;
pub use poly::Poly;
pub use ratio::Ratio;
pub use rational_function::RationalFunction;
pub use twofloat::TwoFloat;
pub use wide::Wide;
