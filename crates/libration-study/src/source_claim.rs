//! Claims of the source report, with their conditions and figures.

use libration::Method;
use serde::Serialize;

use crate::Config;

/// A claim that a study judges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SourceClaim {
    /// Identifier, as `C12`.
    pub id: &'static str,
    /// The integrators of the claim.
    pub integrators: &'static [Method],
    /// Whether the claim concerns only the run of the source, not other settings.
    pub own_run: bool,
    /// Figures with the evidence: numbers in the source report, or identifiers.
    pub figures: &'static [&'static str],
}

/// A claim without a verdict in a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct UnjudgedClaim {
    /// Identifier, as `C12`.
    pub id: &'static str,
    /// Reason for the missing verdict.
    pub because: String,
    /// The study that judges the claim, if it was not run.
    #[serde(skip)]
    pub missing: Option<&'static str>,
}

impl SourceClaim {
    /// Returns a claim about integrators, with its figures.
    pub const fn new(
        id: &'static str,
        integrators: &'static [Method],
        figures: &'static [&'static str],
    ) -> Self {
        SourceClaim { id, integrators, own_run: false, figures }
    }

    /// Returns a claim about the run whose numbers are in the source report.
    pub const fn of_the_source_run(
        id: &'static str,
        integrators: &'static [Method],
        figures: &'static [&'static str],
    ) -> Self {
        SourceClaim { own_run: true, ..SourceClaim::new(id, integrators, figures) }
    }

    /// Returns the sort key: C9 before C10, C59a after C59.
    pub fn order(&self) -> (u32, &'static str) {
        order(self.id)
    }

    /// Returns the reason for a missing verdict with this configuration.
    pub fn reason_unjudged(&self, config: &Config) -> String {
        let left_out = self.integrators.iter().filter(|m| !config.integrators.contains(m));
        let left_out: Vec<&str> = left_out.map(|m| m.title()).collect();
        if !left_out.is_empty() {
            return format!(
                "about integrators that are not in the configuration: {}",
                left_out.join(", ")
            );
        }
        if self.own_run {
            return "about the source’s own run: ω² = 10 s⁻², from (1, 0), a million steps of \
                    1 ms"
                .into();
        }
        "without evidence with these settings: drifts within rounding, unstable steps, or missing horizons, \
         systems, implementations or numbers of trajectories"
            .into()
    }
}

/// Returns the sort key of a claim: C9 before C10, C59a after C59.
pub fn order(id: &str) -> (u32, &str) {
    (id.chars().filter_map(|c| c.to_digit(10)).fold(0, |n, d| 10 * n + d), id)
}
