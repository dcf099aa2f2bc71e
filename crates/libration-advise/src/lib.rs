//! Advice for simulations and control loops: the largest step of each integrator, and the budget of each timing imperfection.

mod advice;
mod advice_verdict;
mod advisor;
#[cfg(test)]
mod analyze_agreement;
mod budget;
mod catalogue_plant;
mod combined_effect;
mod control;
mod ensemble;
mod file;
mod file_tables;
mod first_screen;
mod free_motion;
mod imperfection;
mod integrator_choice;
pub mod jitter_measurement;
mod limit_text;
mod limits;
pub mod linear;
mod live_setting;
mod loop_check;
mod loop_command;
mod loop_simulation;
mod loops;
mod motion;
mod motion_rates;
mod operating_point;
mod page;
mod region_of_attraction;
mod request;
mod stabilising_changes;
mod stability_map;
mod stability_window;
mod subject;
mod summary;
mod system_programs;
mod throughput;
mod timed_loop;
mod used_share;

use std::ops::RangeInclusive;

use libration::ensemble::EnsembleError;
use thiserror::Error;

pub use advice::{Advice, FloatChoice, LoopAdvice, ToleranceAnswer};
pub use advice_verdict::Doubt;
pub use budget::{Budget, FirstFailure, rounded};
pub use combined_effect::{CombinedEffect, SimulatedCost};
pub use control::{Control, Correction, Law, Regulator};
pub use file::{DEFAULT, parse};
pub use imperfection::Imperfection;
pub use integrator_choice::{IntegratorChoice, SearchExtent};
pub use limit_text::rounded_down;
pub use loops::LoopError;
pub use page::page;
pub use region_of_attraction::RegionOfAttraction;
pub use request::{Measure, Request, Tolerance};
pub use stabilising_changes::StabilisingChanges;
pub use stability_map::StabilityMap;
pub use stability_window::StabilityWindow;
pub use throughput::Throughput;

use libration_settings::duration;
use libration_settings::limits::SIZE;
use libration_work::{Interrupted, Work};
use system_programs::SystemPrograms;

/// Allowed angles of the fastest motion of a loop per period, in rad. Below, growth per period is lost to rounding; above, second
/// moments under jitter cannot be derived.
const TURN: RangeInclusive<f64> = 1e-9..=1e3;

/// [`TURN`] in words.
const TURNS: &str = "1e-9 to 1e3";

/// Error of [`advise`].
#[derive(Debug, Error)]
pub enum AdviseError {
    /// A number is invalid.
    #[error("{name} is {value:?}; it must be {allowed}")]
    Value {
        /// The name of the number.
        name: &'static str,
        /// The value.
        value: f64,
        /// The allowed values.
        allowed: &'static str,
    },
    /// The latency is far too long for the period.
    #[error("--latency: {}", duration::excessive_latency(*seconds, *period))]
    ExcessiveLatency {
        /// The latency, in s.
        seconds: f64,
        /// The period, in s.
        period: f64,
    },
    /// A parameter of the system is too large or too small.
    #[error("{system}: `{name}` is {value:e}; expected 0, or {:e} to {:e} in size", SIZE.start(), SIZE.end())]
    Parameter {
        /// The system.
        system: String,
        /// The parameter.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// The period does not fit the motions of the loop.
    #[error(
        "the period is {period:e} s; expected {allowed}, in which the fastest motion of this loop turns by {TURNS} rad"
    )]
    Period {
        /// The period, in s.
        period: f64,
        /// The periods that are allowed, in words.
        allowed: String,
    },
    /// The tolerance is not defined for the request.
    #[error("a tolerance of {} is not possible: {why}", of.name())]
    Tolerance {
        /// The measure of the tolerance.
        of: Measure,
        /// The reason.
        why: String,
    },
    /// The system has too many degrees of freedom.
    #[error("{system} in {dimension} degrees of freedom: {allowed}")]
    Dimension {
        /// The system.
        system: String,
        /// The degrees of freedom.
        dimension: usize,
        /// The allowed degrees of freedom, in words.
        allowed: &'static str,
    },
    /// The ideal loop is unstable.
    #[error(
        "the loop is unstable without latency, jitter, skew and loss: {}; help: {help}",
        modes.join("; ")
    )]
    Unstable {
        /// The motions that do not decay, in words, fastest first.
        modes: Vec<String>,
        /// Changes that stabilise the loop, in words.
        help: String,
    },
    /// The loop is unstable with its latency alone, and too large to be analysed with jitter or losses.
    #[error(
        "the loop is unstable with its latency of {0} s alone; with jitter or losses the latency is too long to analyse"
    )]
    LatencyTooLong(f64),
    /// The loop is invalid.
    #[error(transparent)]
    Loop(#[from] LoopError),
    /// There is no redesign for the request.
    #[error("no redesign is possible: {0}")]
    Redesign(&'static str),
    /// The simulation of loops failed.
    #[error(transparent)]
    Ensemble(#[from] EnsembleError),
    /// The user stopped the work.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
}

/// Advises on `request`.
///
/// # Errors
/// [`AdviseError`]; errors of the request are returned before any work.
pub fn advise(work: &Work<'_>, request: &Request) -> Result<Advice, AdviseError> {
    request.check()?;
    match &request.control {
        None => advisor::advise_simulation(work, &SystemPrograms::new(&request.system), request),
        Some(control) => catalogue_plant::advise(work, control, request),
    }
}

/// The budget of each imperfection of the loop of `request`, none without a loop: the part of [`advise`] without simulations.
///
/// # Errors
/// As of [`advise`].
pub fn budgets(work: &Work<'_>, request: &Request) -> Result<Vec<Budget>, AdviseError> {
    request.check()?;
    match &request.control {
        None => Ok(Vec::new()),
        Some(control) => catalogue_plant::budgets(work, control, request),
    }
}
