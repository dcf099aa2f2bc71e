//! Outcomes of simulations.

use libration::Float;
use libration_report::verdict::Verdict;
use serde::Serialize;
use serde_json::{Value, json};

use super::{Request, overflow};
use crate::newton_residual::NewtonResidual;

/// The outcome of a simulation.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// All states are finite.
    Complete,
    /// All states are finite. The steps solved equations by an iteration, which left a residual.
    Iterated(NewtonResidual),
    /// All states are finite, but the energy of the single trajectory grows, which no force explains.
    EnergyDiverges {
        /// The fault.
        verdict: Verdict,
        /// What an iteration left in the steps.
        newton_residual: Option<NewtonResidual>,
    },
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
        /// What an iteration left in the steps before.
        newton_residual: Option<NewtonResidual>,
    },
}

impl Outcome {
    /// The outcome of the ensemble of `request` with the trajectories `lost` that are not finite.
    pub(super) fn of<S: Float>(request: &Request, lost: &[usize]) -> Self {
        Outcome::of_ensemble(lost, || overflow::cause::<S>(request, None))
    }

    /// The outcome of an ensemble with the trajectories `lost` that are not finite, if there are any, and its cause.
    pub(crate) fn of_ensemble(lost: &[usize], cause: impl FnOnce() -> Option<String>) -> Self {
        match lost.len() {
            0 => Outcome::Complete,
            count => Outcome::NotFinite {
                count,
                first: lost.iter().copied().take(10).collect(),
                reason: cause(),
                newton_residual: None,
            },
        }
    }

    /// The same outcome, of steps that left a residual.
    #[must_use]
    pub(crate) fn with_residual(self, residual: Option<NewtonResidual>) -> Self {
        let Some(residual) = residual else { return self };
        let cause = |reason: String| match residual.error() {
            Some(error) => format!("{reason}; {error}"),
            None => reason,
        };
        match self {
            Outcome::Complete | Outcome::Iterated(_) => Outcome::Iterated(residual),
            Outcome::EnergyDiverges { verdict, .. } => {
                Outcome::EnergyDiverges { verdict, newton_residual: Some(residual) }
            }
            Outcome::Diverged(own) => Outcome::Diverged(Divergence {
                reason: cause(own.reason),
                newton_residual: Some(residual),
                ..own
            }),
            Outcome::NotFinite { count, first, reason, .. } => {
                let reason = match (reason, residual.error()) {
                    (Some(reason), _) => Some(cause(reason)),
                    (None, error) => error,
                };
                Outcome::NotFinite { count, first, reason, newton_residual: Some(residual) }
            }
        }
    }

    /// The same outcome, with what the energy says of a trajectory whose states are finite.
    #[must_use]
    pub(crate) fn with_energy(self, fault: Option<Verdict>) -> Self {
        match (self, fault) {
            (Outcome::Complete, Some(verdict)) => {
                Outcome::EnergyDiverges { verdict, newton_residual: None }
            }
            (Outcome::Iterated(residual), Some(verdict)) => {
                Outcome::EnergyDiverges { verdict, newton_residual: Some(residual) }
            }
            (outcome, _) => outcome,
        }
    }

    /// What the iterations of implicit steps left; none without iterations.
    pub fn newton_residual(&self) -> Option<&NewtonResidual> {
        match self {
            Outcome::Complete => None,
            Outcome::Iterated(residual) => Some(residual),
            Outcome::Diverged(own) => own.newton_residual.as_ref(),
            Outcome::NotFinite { newton_residual, .. }
            | Outcome::EnergyDiverges { newton_residual, .. } => newton_residual.as_ref(),
        }
    }

    /// The keys and values of the outcome in a file.
    pub(crate) fn json_entries(&self, several: bool) -> Vec<(&'static str, Value)> {
        let mut entries = vec![self.json_entry(several)];
        if let Some(residual) = self.newton_residual() {
            entries.push(("newton_residual", json!(residual)));
        }
        let verdict = match self {
            Outcome::EnergyDiverges { verdict, .. } => Some(verdict.clone()),
            _ => self.newton_residual().map(NewtonResidual::verdict),
        };
        entries.extend(verdict.map(|verdict| ("verdict", json!(verdict))));
        entries
    }

    fn json_entry(&self, several: bool) -> (&'static str, Value) {
        match self {
            Outcome::Diverged(stopped) => ("stopped", json!(stopped)),
            Outcome::NotFinite { count, first, reason, .. } => {
                let mut entry = json!({ "count": count, "first": first });
                if let Some(reason) = reason {
                    entry["reason"] = json!(reason);
                }
                ("not_finite", entry)
            }
            Outcome::Complete | Outcome::Iterated(_) if several => {
                ("not_finite", json!({ "count": 0, "first": [] }))
            }
            Outcome::Complete | Outcome::Iterated(_) | Outcome::EnergyDiverges { .. } => {
                ("stopped", Value::Null)
            }
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
    /// What an iteration left in the steps before.
    #[serde(skip)]
    pub newton_residual: Option<NewtonResidual>,
}
