//! What a run found, as `results.json` holds it.

use libration_report::Record;
use libration_study::{Config, Machine, Unjudged};
use serde::Serialize;

use crate::untried::Untried;

/// Version of the contract that `results.json` keeps.
pub const SCHEMA: &str = "libration.results/1";

/// Everything that a run found; `results.json` holds just this.
#[derive(Clone, Debug, Serialize)]
pub struct Results {
    /// Version of this contract.
    pub schema: &'static str,
    /// Where it was run.
    pub machine: Machine,
    /// What was asked.
    pub config: Config,
    /// Wall-clock time so far, in seconds.
    pub seconds: f64,
    /// Whether all studies that were asked for are in it.
    pub complete: bool,
    /// Claims of the source report that no study tries, and why.
    pub untried: &'static [Untried],
    /// Claims that studies try, but that none has judged in this run, and why.
    pub unjudged: Vec<Unjudged>,
    /// The records of the studies that have ended.
    pub studies: Vec<Record>,
}
