//! The studies, in the order in which they are told.

mod asynchrony;
mod changed;
mod convergence;
mod coverage;
mod desk;
mod determinism;
mod drift;
mod efficiency;
mod error;
mod growth;
mod hierarchy;
mod ink;
mod jitter;
mod latency;
mod memory;
mod nonlinear;
mod precision;
mod regime;
mod reported;
mod rollout;
mod rounding;
mod sample;
mod sampled;
mod source;
mod spectrum;
mod stability;
mod storage;
mod subject;
mod swarm;
pub(crate) mod throughput;

use crate::study::Study;
pub use asynchrony::Asynchrony;
pub use convergence::Convergence;
pub use determinism::Determinism;
pub use drift::Drift;
pub use efficiency::Efficiency;
pub use error::Error;
pub use hierarchy::Hierarchy;
pub use jitter::Jitter;
pub use latency::Latency;
pub use memory::Memory;
pub use nonlinear::Nonlinear;
pub use precision::Precision;
pub use rollout::Rollout;
pub use spectrum::Spectrum;
pub use stability::Stability;
pub use storage::Storage;
pub use subject::{
    Change, Changes, Errors, Halvings, Horizon, Kind, Law, Orbits, Portrait, Problem, SYSTEMS,
    Subject, Symmetry,
};
pub use throughput::Throughput;

/// All studies.
pub const ALL: &[&dyn Study] = &[
    &Spectrum,
    &Drift,
    &Error,
    &Stability,
    &Efficiency,
    &Convergence::CONFIGURED,
    &Nonlinear::CONFIGURED,
    &Precision,
    &Latency,
    &Jitter,
    &Asynchrony,
    &Hierarchy,
    &Determinism,
    &Throughput,
    &Memory,
    &Rollout,
    &Storage,
];

/// The study of that name, if there is one.
pub fn by_name(name: &str) -> Option<&'static dyn Study> {
    ALL.iter().copied().find(|study| study.name() == name)
}
