//! Latency, lag, gain and noise of a real loop from a log of its commands and of the responses to them.
//!
//! A response is a plant behind a dead time: `ẋ = A x + B (K u(t − τ) + b)`, `y = C x + e`, sampled at any times. Its likelihood is exact,
//! for a dead time that is any part of a period. [`identify`] maximises it.

mod arrival_filter;
mod arrival_information;
mod arrival_parameters;
mod arrival_selection;
mod arrivals;
mod bootstrap;
mod candidate;
mod dependence;
mod effort;
mod estimate;
mod excitation;
mod hold;
mod hypothesis;
mod identification;
mod identify;
mod information;
mod initial_states;
mod interval;
mod likelihood_map;
mod loop_file;
mod minimum;
mod model;
mod noise;
mod page;
mod parameters;
mod plant_step;
mod quantiles;
mod recording;
mod regression;
mod request;
mod residuals;
mod response;
mod selection;
mod simulation;
mod small_step;
mod start;
mod summary;
mod task;
mod verdict;
mod warnings;
mod whitening;

pub use bootstrap::BootstrapRow;
pub use candidate::CandidateRow;
pub use excitation::ExcitationRow;
pub use hold::Hold;
pub use identification::{FitSeries, Identification, StateSpace};
pub use identify::identify;
pub use interval::Interval;
pub use likelihood_map::LikelihoodMap;
pub use loop_file::loop_file;
pub use noise::NoiseKind;
pub use page::page;
pub use parameters::Estimated;
pub use quantiles::LEVEL;
pub use recording::{FEWEST_RESPONSES, Recording, RecordingError};
pub use request::{IdentifyError, MOST_BOOTSTRAPS, MOST_RESPONSES, Request};
pub use residuals::{CONTRADICTION, ResidualTests};
pub use response::{KnownPlant, ParameterName, ResponseKind};
pub use simulation::SimulatedLoop;
pub use start::Start;
pub use summary::{interval, with_unit};
