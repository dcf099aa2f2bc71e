//! Audits of the step of any simulator, which is known by its results alone.
//!
//! [`probe()`] calls a [`BlackBox`] and measures: the matrices of its step and of the flow that it approximates, modes with their numerical
//! damping, the longest stable step, hidden latency, order, integrator, defects and bits. A [`Subject`] names states and actions.

mod audit;
mod bits;
mod black_box;
mod child_process;
mod child_streams;
mod confirmation;
mod convergence;
mod decay;
mod defects;
mod delay_audit;
mod description;
mod differences;
mod driven_velocity;
mod energy_drift;
mod energy_finding;
mod finding;
mod finding_kind;
mod findings;
mod first_difference;
mod first_screen;
mod flow;
mod gains;
mod held_action;
mod hidden_latency;
mod impulse;
mod integrator_page;
mod largest_step;
mod linear_candidates;
mod linearised_step;
mod live_setting;
mod matrices;
mod matrix_step;
mod memory;
mod memory_finding;
mod mode_plane;
mod modes;
mod noise_free_matrix;
mod observed;
mod operating_point;
mod page;
mod prober;
mod process_group;
mod rate_ranges;
mod rates;
mod recognition;
mod reference_check;
mod report;
mod rest;
mod rounding;
mod settled_order;
mod settling;
mod shorter_step;
mod step_equilibrium;
mod subject;
mod summary;

pub use audit::probe;
pub use bits::{BitCheck, Bits, Randomness};
pub use black_box::{BlackBox, BlackBoxError};
pub use child_process::ChildProcess;
pub use confirmation::Confirmation;
pub use convergence::Convergence;
pub use defects::Defects;
pub use delay_audit::DelayAudit;
pub use description::{Description, DescriptionError};
pub use differences::{Jacobian, jacobian};
pub use driven_velocity::DrivenVelocity;
pub use energy_drift::{DriftReason, EnergyDrift};
pub use finding::Finding;
pub use finding_kind::FindingKind;
pub use first_difference::{FirstDifference, ulps};
pub use gains::{
    GainReport, IntegratorRow, JointRow, MeasuredGains, ServoError, ServoGain, ServoIntegrator,
    ServoMode, ServoRow, Servos, ServosDescription, Torque, gains, gains_page,
};
pub use hidden_latency::HiddenLatency;
pub use impulse::Lateness;
pub use largest_step::LargestStep;
pub use matrices::Matrices;
pub use matrix_step::MatrixStep;
pub use memory::Memory;
pub use modes::{ProbedMode, Rates};
pub use observed::Observed;
pub use operating_point::{LargestChange, OperatingPoint, StandingRun};
pub use page::page;
pub use process_group::end_programs;
pub use recognition::{Candidate, Match, Recognition};
pub use reference_check::ReferenceCheck;
pub use report::ProbeReport;
pub use rest::Rest;
pub use rounding::Rounding;
pub use settling::Settling;
pub use subject::{Recording, Reference, Subject, SubjectError};
pub use summary::error_in_words;
