//! The studies, in the order of the report.

use libration_study::Registry;
use libration_study_batch::{Determinism, Memory, Rollout, Storage, Throughput};
use libration_study_loops::{Asynchrony, Hierarchy, Jitter, Latency};
use libration_study_motion::{
    Adaptive, Convergence, Drift, Efficiency, Error, Nonlinear, Precision, Spectrum, Stability,
};

/// All studies, in the order of the report.
pub const STUDIES: Registry = Registry {
    studies: &[
        &Spectrum,
        &Drift,
        &Error,
        &Stability,
        &Efficiency,
        &Convergence::FROM_CONFIGURATION,
        &Nonlinear::FROM_CONFIGURATION,
        &Adaptive,
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
    ],
};
