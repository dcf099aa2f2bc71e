//! One trajectory, stepped with a fixed time step and watched by observers.

mod counted;
mod observer;
mod simulator;

pub use counted::Counted;
pub use observer::{EnergyDrift, Every, Observer, Sample};
pub use simulator::{SimulationError, Simulator};
