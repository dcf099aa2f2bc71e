//! Claims of the source report that a study tries: what each needs, and which figures show it.

use libration::Method;
use serde::Serialize;

use crate::Config;

/// A claim that a study tries.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tried {
    /// Number in the ledger.
    pub id: &'static str,
    /// The integrators that it speaks of.
    pub integrators: &'static [Method],
    /// Whether it speaks of the source's own run, and says nothing of other settings.
    pub own_run: bool,
    /// The figures that show its evidence: numbers in the source report, or identifiers.
    pub figures: &'static [&'static str],
}

/// A claim that was not judged by a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Unjudged {
    /// Number in the ledger.
    pub id: &'static str,
    /// Why it was not judged.
    pub because: String,
    /// The study that would have tried it, if that was not run.
    #[serde(skip)]
    pub missing: Option<&'static str>,
}

impl Tried {
    /// A claim about these integrators, which these figures show.
    pub const fn new(
        id: &'static str,
        integrators: &'static [Method],
        figures: &'static [&'static str],
    ) -> Self {
        Tried { id, integrators, own_run: false, figures }
    }

    /// A claim about the run of which the source prints numbers.
    pub const fn of_the_source_run(
        id: &'static str,
        integrators: &'static [Method],
        figures: &'static [&'static str],
    ) -> Self {
        Tried { own_run: true, ..Tried::new(id, integrators, figures) }
    }

    /// The place in the ledger: C9 stands before C10, and C59a behind C59.
    pub fn order(&self) -> (u32, &'static str) {
        order(self.id)
    }

    /// Why no run under this configuration judged it.
    pub fn why_not(&self, config: &Config) -> String {
        let left_out = self.integrators.iter().filter(|m| !config.integrators.contains(m));
        let left_out: Vec<&str> = left_out.map(|m| m.title()).collect();
        if !left_out.is_empty() {
            return format!("about integrators that were left out: {}", left_out.join(", "));
        }
        if self.own_run {
            return "about the source’s own run: ω² = 10 s⁻², from (1, 0), a million steps of \
                    1 ms"
                .into();
        }
        "without evidence at this setting: drifts within rounding, steps beyond the limits of \
         stability, or horizons, systems, implementations and numbers of trajectories that were not tried"
            .into()
    }
}

/// The place of a claim in the ledger: C9 stands before C10, and C59a behind C59.
pub fn order(id: &str) -> (u32, &str) {
    (id.chars().filter_map(|c| c.to_digit(10)).fold(0, |n, d| 10 * n + d), id)
}
