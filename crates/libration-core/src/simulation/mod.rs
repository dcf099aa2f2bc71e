//! One trajectory, stepped with a fixed time step and watched by observers.

mod evaluation_counter;
mod observer;
mod simulator;

pub use evaluation_counter::CountedSystem;
pub use observer::{EnergyDrift, Every, Observer, Sample};
pub use simulator::{SimulationError, Simulator};
