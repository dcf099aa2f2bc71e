//! Results of a run, as in `results.json`.

use libration_report::Record;
use libration_study::{Config, Machine, UnjudgedClaim};
use serde::Serialize;

use crate::claims_without_study::ClaimWithoutStudy;

/// Version of the format of `results.json`.
pub const SCHEMA: &str = "libration.results/1";

/// Results of a run, the content of `results.json`.
#[derive(Clone, Debug, Serialize)]
pub struct Results {
    /// Version of the format.
    pub schema: &'static str,
    /// The machine of the run.
    pub machine: Machine,
    /// The configuration of the run.
    pub config: Config,
    /// Wall-clock time so far in s.
    pub seconds: f64,
    /// Whether all requested studies are included.
    pub complete: bool,
    /// Claims of the source report that no study judges, with reasons.
    pub claims_without_study: &'static [ClaimWithoutStudy],
    /// Claims that studies try, but that none has judged in this run, and why.
    pub unjudged: Vec<UnjudgedClaim>,
    /// The records of the studies that have ended.
    pub studies: Vec<Record>,
}
