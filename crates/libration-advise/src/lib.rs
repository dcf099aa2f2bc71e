//! What can be afforded: the budget of a simulation or a loop.

mod about;
#[cfg(test)]
mod agreement;
mod answer;
mod budget;
mod choice;
mod control;
mod ensemble;
mod file;
mod free;
mod limits;
mod loops;
mod making;
mod map;
mod pace;
mod page;
mod regained;
mod remedies;
mod request;
mod returns;
mod stepped;
mod tables;
mod throughput;
mod together;
pub mod wakeups;
mod words;

use std::ops::RangeInclusive;

use libration::ensemble::EnsembleError;
use libration::{AnySystem, with_system};
use thiserror::Error;

pub use answer::{Advice, FloatChoice, LoopAdvice, ToleranceAnswer};
pub use budget::{Budget, Failing};
pub use choice::Choice;
pub use control::{Control, Correction, Law, Regulator};
pub use file::{DEFAULT, parse};
pub use limits::Kind;
pub use loops::LoopError;
pub use map::Map;
pub use page::page;
pub use regained::Regained;
pub use remedies::Remedies;
pub use request::{Measure, Request, Tolerance};
pub use returns::Returns;
pub use throughput::Throughput;
pub use together::{Simulated, Together};

use libration_settings::limits::SIZE;
use libration_work::{Interrupted, Work};

/// The angles by which the fastest motion of a loop may turn in a period, in rad. Below, a float knows no growth in a period;
/// above, jitter turns a step by more than second moments can be derived for.
const TURN: RangeInclusive<f64> = 1e-9..=1e3;

/// The same for a reader.
const TURNS: &str = "1e-9 to 1e3";

/// Why there is no advice.
#[derive(Debug, Error)]
pub enum AdviseError {
    /// A number cannot be.
    #[error("{name} is {value:?}; it must be {allowed}")]
    Value {
        /// Which.
        name: &'static str,
        /// What it is.
        value: f64,
        /// What it may be.
        allowed: &'static str,
    },
    /// A parameter of the system is too large or too small.
    #[error("{system}: `{name}` is {value:e}; expected 0, or {:e} to {:e} in size", SIZE.start(), SIZE.end())]
    Parameter {
        /// The system.
        system: &'static str,
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
    /// The tolerance does not fit what is asked.
    #[error("{} cannot be tolerated here: {why}", of.name())]
    Tolerance {
        /// Of what.
        of: Measure,
        /// Why not.
        why: String,
    },
    /// The system has too many degrees of freedom.
    #[error("{system} in {dimension} degrees of freedom: {allowed}")]
    Dimension {
        /// Which.
        system: &'static str,
        /// How many.
        dimension: usize,
        /// How many there may be.
        allowed: &'static str,
    },
    /// The loop is unstable without anything wrong with it.
    #[error(
        "the loop is unstable without latency, jitter, skew and loss: {}; help: {help}",
        modes.join("; ")
    )]
    Unstable {
        /// The motions that do not decay, in words, the fastest first.
        modes: Vec<String>,
        /// What stabilises it, in words.
        help: String,
    },
    /// The loop does not stand its latency, and with what else is stated it is too large to be told of.
    #[error(
        "the loop does not stand its latency of {0} s alone; with jitter or losses it is too long to be told of"
    )]
    Late(f64),
    /// The loop cannot be made.
    #[error(transparent)]
    Loop(#[from] LoopError),
    /// Loops could not be simulated.
    #[error(transparent)]
    Ensemble(#[from] EnsembleError),
    /// The user stopped the work.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
}

/// Advises on `request`.
///
/// # Errors
/// [`AdviseError`], and those that are about the request before any work.
pub fn advise(work: &Work<'_>, request: &Request) -> Result<Advice, AdviseError> {
    request.check()?;
    match (&request.control, request.system) {
        (None, system) => with_system!(
            system,
            request.q.len(),
            |model, D| {
                if const { D <= 2 } {
                    making::free::<_, D>(work, model, request)
                } else {
                    too_many(request, "there may be two")
                }
            },
            too_many(request, "the system has another number of them")
        ),
        (Some(control), AnySystem::Oscillator(model)) if request.q.len() == 1 => {
            making::looped(work, model, control, request)
        }
        (Some(control), AnySystem::DampedOscillator(model)) => {
            making::looped(work, model, control, request)
        }
        (Some(control), AnySystem::Pendulum(model)) => {
            making::looped(work, model, control, request)
        }
        (Some(control), AnySystem::Duffing(model)) => making::looped(work, model, control, request),
        _ => too_many(request, "a loop is advised on in one"),
    }
}

/// What the loop of `request` stands of each imperfection alone: the part of [`advise`] that simulates nothing.
///
/// # Errors
/// As of [`advise`].
pub fn budgets(work: &Work<'_>, request: &Request) -> Result<Vec<Budget>, AdviseError> {
    request.check()?;
    match (&request.control, request.system) {
        (Some(control), AnySystem::Oscillator(model)) if request.q.len() == 1 => {
            making::budgets(work, model, control, request)
        }
        (Some(control), AnySystem::DampedOscillator(model)) => {
            making::budgets(work, model, control, request)
        }
        (Some(control), AnySystem::Pendulum(model)) => {
            making::budgets(work, model, control, request)
        }
        (Some(control), AnySystem::Duffing(model)) => {
            making::budgets(work, model, control, request)
        }
        _ => too_many(request, "a loop is advised on in one"),
    }
}

fn too_many<T>(request: &Request, allowed: &'static str) -> Result<T, AdviseError> {
    let (system, dimension) = (request.system.name(), request.q.len());
    Err(AdviseError::Dimension { system, dimension, allowed })
}
