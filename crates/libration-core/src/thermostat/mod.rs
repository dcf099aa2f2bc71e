//! Steps of Langevin dynamics: `dq = v dt`, `m dv = F(q) dt − γ m v dt + √(2γ m kT) dW`.
//!
//! A step takes its random numbers as arguments, so that one definition simulates on floats and yields its own linear map and the
//! covariance of its noise on any number type.

mod langevin_method;
mod langevin_step;
mod langevin_word;

pub use langevin_method::{LangevinMethod, UnknownThermostat};
pub use langevin_step::LangevinStep;
pub use langevin_word::{LangevinLetter, LangevinWord, MOST_LETTERS, WordError};
