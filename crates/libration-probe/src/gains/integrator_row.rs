//! The answer of an integrator to gains.

use serde::Serialize;

use super::limit_in_json::limit;
use super::report::MOST_SUBSTEPS;

/// The answer of an integrator to the gains.
#[derive(Clone, Debug, Serialize)]
pub struct IntegratorRow {
    /// Its name.
    pub name: &'static str,
    /// The same in running text.
    pub title: String,
    /// Whether the gains hold; not if that is unknown.
    pub holds: bool,
    /// Whether it is known if they hold.
    pub is_known: bool,
    /// The largest factor of all gains of position.
    #[serde(serialize_with = "limit")]
    pub largest_factor: f64,
    /// The least factor, if the given gains are too small; else 0.
    pub least_factor: f64,
    /// The fewest substeps.
    pub fewest_substeps: Option<u32>,
    /// The largest factor of a mode per substep.
    pub spectral_radius: f64,
    /// The same less 1, without cancellation.
    pub spectral_radius_minus_one: f64,
}

impl IntegratorRow {
    /// The fewest substeps in words.
    pub fn substeps(&self) -> String {
        match self.fewest_substeps {
            Some(count) => count.to_string(),
            None if !self.is_known => "unknown".into(),
            None => format!("above {MOST_SUBSTEPS}"),
        }
    }

    /// Whether the gains hold, in a word.
    pub fn answer(&self) -> &'static str {
        match (self.is_known, self.holds) {
            (false, _) => "unknown",
            (true, true) => "yes",
            (true, false) => "no",
        }
    }
}
