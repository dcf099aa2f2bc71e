//! Results of a run, as in `results.json`.

use libration::live::Setting;
use libration_analyze::SystemSummary;
use libration_report::Record;
use libration_study::{Config, Machine, UnjudgedClaim};
use serde::Serialize;

use crate::claims_without_study::ClaimWithoutStudy;
use crate::system_studies::NotApplicable;

/// Version of the format of `results.json`.
pub const SCHEMA: &str = "libration.results/1";

/// Results of a run, the content of `results.json`.
#[derive(Clone, Debug, Serialize)]
pub struct Results {
    /// Version of the format.
    pub schema: &'static str,
    /// The command of the run, without names of studies; with `--only` and an identifier it recomputes one finding alone.
    pub command: String,
    /// The machine of the run.
    pub machine: Machine,
    /// The configuration of the run.
    pub config: Config,
    /// The system of equations under study; none without one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub system: Option<StudiedSystem>,
    /// Wall-clock time so far in s.
    pub seconds: f64,
    /// Whether all requested studies are included.
    pub complete: bool,
    /// Claims of the source report that no study judges, with reasons.
    pub claims_without_study: &'static [ClaimWithoutStudy],
    /// Claims that studies try, but that none has judged in this run, and why.
    pub unjudged: Vec<UnjudgedClaim>,
    /// The studies that do not apply to the system, with reasons.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub not_applicable: Vec<NotApplicable>,
    /// The records of the studies that have ended.
    pub studies: Vec<Record>,
}

/// A system of equations under study.
#[derive(Clone, Debug, Serialize)]
pub struct StudiedSystem {
    /// Its properties.
    #[serde(flatten)]
    pub summary: SystemSummary,
    /// Its turn in s, of which time steps are fractions.
    pub turn: f64,
    /// The number of studies that apply to it.
    #[serde(skip)]
    pub study_count: usize,
    /// The options that name it to any command.
    #[serde(skip)]
    pub options: String,
    /// The setting of the live section of its page.
    #[serde(skip)]
    pub live: Setting,
}
