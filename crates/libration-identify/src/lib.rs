//! Latency, lag, gain and noise of a real loop from a log of its commands and of the responses to them.
//!
//! A response is a plant behind a dead time: `ẋ = A x + B (K u(t − τ) + b)`, `y = C x + e`, sampled at any times. Its likelihood is exact,
//! for a dead time that is any part of a period.

mod estimate;
mod hold;
mod information;
mod interval;
mod minimum;
mod model;
mod noise;
mod plant_step;
mod quantiles;
mod recording;
mod regression;
mod response;
mod simulation;
#[cfg(test)]
mod tries;
mod whitening;

pub use hold::Hold;
pub use interval::Interval;
pub use noise::NoiseKind;
pub use recording::{FEWEST_RESPONSES, Recording, RecordingError};
pub use response::{KnownPlant, ParameterName, ResponseKind};
pub use simulation::SimulatedLoop;
