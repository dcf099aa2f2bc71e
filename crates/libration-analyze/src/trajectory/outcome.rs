//! Outcomes of simulations.

use libration::Float;
use serde::Serialize;
use serde_json::{Value, json};

use super::{Request, overflow};

/// The outcome of a simulation.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// All states are finite.
    Complete,
    /// The single trajectory ended early.
    Diverged(Divergence),
    /// Some trajectories of an ensemble are not finite at the end. They do not affect the others.
    NotFinite {
        /// Number of them.
        count: usize,
        /// The first ten.
        first: Vec<usize>,
        /// The cause and a suggestion, if they are known.
        reason: Option<String>,
    },
}

impl Outcome {
    /// The outcome of the ensemble of `request` with the trajectories `lost` that are not finite.
    pub(super) fn of<S: Float>(request: &Request, lost: &[usize]) -> Self {
        Outcome::of_ensemble(lost, || overflow::cause::<S>(request))
    }

    /// The outcome of an ensemble with the trajectories `lost` that are not finite, if there are any, and its cause.
    pub(crate) fn of_ensemble(lost: &[usize], cause: impl FnOnce() -> Option<String>) -> Self {
        match lost.len() {
            0 => Outcome::Complete,
            count => Outcome::NotFinite {
                count,
                first: lost.iter().copied().take(10).collect(),
                reason: cause(),
            },
        }
    }

    /// The key and value of the outcome in a file.
    pub(crate) fn json_entry(&self, several: bool) -> (&'static str, Value) {
        match self {
            Outcome::Diverged(stopped) => ("stopped", json!(stopped)),
            Outcome::NotFinite { count, first, reason } => {
                let mut entry = json!({ "count": count, "first": first });
                if let Some(reason) = reason {
                    entry["reason"] = json!(reason);
                }
                ("not_finite", entry)
            }
            Outcome::Complete if several => ("not_finite", json!({ "count": 0, "first": [] })),
            Outcome::Complete => ("stopped", Value::Null),
        }
    }
}

/// The end of a trajectory with a state that is not finite.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Divergence {
    /// The first step with a result that is not finite. The last row belongs to the step before.
    pub step: u64,
    /// Its time in seconds.
    pub t: f64,
    /// The event, with its cause and a suggestion if they are known.
    pub reason: String,
}
