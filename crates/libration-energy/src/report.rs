//! The results of an audit.

use libration_report::verdict::{Verdict, exit_code};
use serde::Serialize;

use crate::{DriftCause, Finding, LargestDt, OscillationCause, PowerLaw, Run, WalkCause};

/// The results of an audit of energy traces; the fields are the keys of `audit --json`.
#[derive(Clone, Debug, Serialize)]
pub struct EnergyReport {
    /// The answer in a few sentences.
    pub answer: String,
    /// Whether there is a fault; unknown where the runs do not tell.
    pub verdict: Verdict,
    /// Whether all runs keep the tolerance over the horizon; none without a stated tolerance.
    pub tolerance_verdict: Option<Verdict>,
    /// Faults of the simulation, and facts that a reader of the numbers must know.
    pub findings: Vec<Finding>,
    /// The runs, that with the shortest time step first.
    pub runs: Vec<Run>,
    /// How the fluctuation of the energy depends on the step.
    pub oscillation_cause: OscillationCause,
    /// The law of its size; none if fewer than two runs resolve it.
    pub oscillation_law: Option<PowerLaw>,
    /// Why the energy drifts.
    pub drift_cause: DriftCause,
    /// The law of the drift rate, by the runs that resolve it.
    pub drift_law: Option<PowerLaw>,
    /// Why the energy wanders.
    pub walk_cause: WalkCause,
    /// The law of the diffusion, by the runs that have a walk.
    pub walk_law: Option<PowerLaw>,
    /// Whether a run has no stated time step, so that it is taken for the spacing of its samples.
    pub is_dt_assumed: bool,
    /// The largest step for the tolerance over the horizon; none where a time step is assumed.
    pub largest_dt: Option<LargestDt>,
    /// Remarks of the reader of the files that may change a result; [`audit`](crate::audit()) has none.
    pub warnings: Vec<String>,
    /// The version of libration.
    pub libration_version: &'static str,
    /// The command that repeats the audit.
    pub repeat_command: String,
}

impl EnergyReport {
    /// All verdicts.
    pub fn verdicts(&self) -> impl Iterator<Item = &Verdict> {
        [&self.verdict].into_iter().chain(&self.tolerance_verdict)
    }

    /// Whether all verdicts are good; unknown is not.
    pub fn holds(&self) -> bool {
        exit_code(self.verdicts()) == libration_report::verdict::GOOD
    }
}
