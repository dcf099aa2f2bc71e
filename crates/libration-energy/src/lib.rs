//! Audits of energy traces: what an energy drift is made of.
//!
//! [`audit()`] takes the energies of runs of one system at several time steps, by any program. It separates the bounded oscillation of
//! the energy, the drift by truncation, rounding, and what does not fall with the step. It names faults, judges the runs by a tolerance, and predicts the largest step
//! for a tolerance over a horizon. Intervals honour the autocorrelation of the energy.

mod answer;
mod audit;
mod batches;
mod cause;
mod convergence;
mod error;
mod estimate;
mod finding;
mod findings;
mod fluctuation;
mod interval;
mod largest_dt;
mod local_deviations;
mod local_findings;
mod local_level;
mod normal_equations;
mod oscillation_findings;
mod page;
mod periods;
mod power_law;
mod report;
mod run;
mod single_precision;
mod slow_change;
mod trace;
mod verdicts;
mod walk;

pub use audit::audit;
pub use cause::{DriftCause, OscillationCause, WalkCause};
pub use error::TraceError;
pub use estimate::Estimate;
pub use finding::{Finding, FindingKind};
pub use interval::{exponent, interval};
pub use largest_dt::{LargestDt, Requirement};
pub use page::page;
pub use power_law::PowerLaw;
pub use report::EnergyReport;
pub use run::Run;
pub use trace::EnergyTrace;
pub use walk::Walk;
