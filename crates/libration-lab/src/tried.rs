//! Claims of the source report that the studies try: what each needs, and which figures show it.

use libration::Method::{self, ExplicitEuler, Rk4, SymplecticEuler, VelocityVerlet};
use serde::Serialize;

use crate::{Config, Record, Study};

/// A claim that a study tries.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tried {
    /// Number in the ledger.
    pub id: &'static str,
    /// The study that tries it.
    pub study: &'static str,
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

const fn tried(
    id: &'static str,
    study: &'static str,
    integrators: &'static [Method],
    figures: &'static [&'static str],
) -> Tried {
    Tried { id, study, integrators, own_run: false, figures }
}

/// A claim about the run of which the source prints numbers.
const fn of_its_run(
    id: &'static str,
    study: &'static str,
    integrators: &'static [Method],
    figures: &'static [&'static str],
) -> Tried {
    Tried { id, study, integrators, own_run: true, figures }
}

const EULERS_VERLET: &[Method] = &[ExplicitEuler, SymplecticEuler, VelocityVerlet];
const FOUR: &[Method] = &[ExplicitEuler, SymplecticEuler, VelocityVerlet, Rk4];

/// All of them, in the order of their numbers.
pub const TRIED: &[Tried] = &[
    tried("C01", "throughput", &[], &["9.7"]),
    tried("C02", "throughput", &[], &["9.7"]),
    of_its_run("C03", "drift", &[VelocityVerlet, Rk4], &["9.1", "crossover"]),
    // Of the oscillator itself, before any step.
    tried("C04", "spectrum", &[], &[]),
    tried("C05", "spectrum", &[ExplicitEuler], &["stability-regions", "9.4"]),
    // A single orbit at z = 2.
    tried("C06", "spectrum", &[SymplecticEuler], &[]),
    tried("C07", "convergence", &[ExplicitEuler, Rk4], &["order-global", "order-local"]),
    tried("C08", "spectrum", &[ExplicitEuler], &["stability-regions"]),
    tried("C09", "spectrum", &[SymplecticEuler], &["stability-regions"]),
    tried("C10", "drift", &[SymplecticEuler], &["9.1", "9.2"]),
    // Defects that are zero.
    tried("C11", "spectrum", &[SymplecticEuler, VelocityVerlet], &[]),
    tried("C12", "drift", &[VelocityVerlet], &["9.1", "9.2"]),
    tried("C13", "spectrum", &[SymplecticEuler, VelocityVerlet], &["stability-regions"]),
    tried("C14", "spectrum", &[Rk4], &["portraits"]),
    tried("C15", "drift", &[Rk4], &["9.1", "9.2"]),
    of_its_run("C16", "drift", &[VelocityVerlet, Rk4], &["9.1", "crossover"]),
    tried("C17", "spectrum", &[VelocityVerlet], &["stability-regions"]),
    tried("C18", "spectrum", &[VelocityVerlet, Rk4], &["stability-regions"]),
    of_its_run("C19", "error", &[Rk4], &["9.3"]),
    tried("C22", "drift", &[ExplicitEuler], &["9.1", "9.4"]),
    tried("C23", "spectrum", &[SymplecticEuler], &["stability-regions"]),
    tried("C24", "convergence", &[VelocityVerlet], &["order-global"]),
    of_its_run("C25", "drift", &[VelocityVerlet, Rk4], &["9.1", "9.2"]),
    // Equality to the bit.
    tried("C26", "drift", &[], &[]),
    tried("C27", "stability", &[VelocityVerlet, Rk4], &["windows"]),
    tried("C28", "stability", FOUR, &["9.5"]),
    tried("C30", "stability", FOUR, &["9.5"]),
    tried("C32", "spectrum", &[ExplicitEuler], &["stability-regions"]),
    tried("C33", "drift", &[ExplicitEuler, Rk4], &["9.1"]),
    tried("C34", "drift", FOUR, &["portraits"]),
    tried("C35", "stability", FOUR, &["9.5"]),
    tried("C36", "throughput", &[], &["9.7"]),
    tried("C37", "throughput", &[], &["9.7"]),
    tried("C39", "throughput", &[], &["9.7"]),
    tried("C40", "throughput", &[], &["9.7"]),
    tried("C42", "throughput", &[], &["9.8"]),
    tried("C43", "precision", &[SymplecticEuler, VelocityVerlet, Rk4], &["precision-types"]),
    // Of arrays that are counted.
    tried("C44", "throughput", &[], &[]),
    tried("C45", "throughput", &[], &["9.7"]),
    tried("C46", "throughput", &[], &["9.7"]),
    tried("C47", "throughput", &[], &["roofline"]),
    // Products and sums.
    tried("C48", "memory", &[], &[]),
    tried("C49", "rollout", &[], &["step-times"]),
    // Of addresses.
    tried("C50", "rollout", &[], &[]),
    tried("C51", "storage", &[], &["draws"]),
    tried("C52", "memory", &[], &["9.10"]),
    tried("C53", "precision", &[SymplecticEuler, VelocityVerlet, Rk4], &["precision-types"]),
    tried("C53a", "memory", &[], &["9.10"]),
    tried("C54", "memory", &[], &["9.10"]),
    tried("C55", "rollout", &[], &["9.11"]),
    tried("C56", "rollout", &[], &["9.9"]),
    tried("C57", "memory", &[], &["9.10"]),
    // Equality to the bit.
    tried("C58", "rollout", &[], &[]),
    // Of angles, which stand in a table.
    tried("C58a", "precision", &[SymplecticEuler], &[]),
    of_its_run("C59", "precision", &[SymplecticEuler, VelocityVerlet], &[]),
    of_its_run("C59a", "precision", &[VelocityVerlet], &[]),
    tried("C59b", "precision", &[VelocityVerlet], &[]),
    of_its_run("C59c", "precision", &[], &[]),
    tried("C60", "jitter", &[SymplecticEuler, VelocityVerlet, Rk4], &["9.13", "jitter-map"]),
    tried("C61", "latency", &[], &["9.14", "9.15"]),
    tried("C62", "latency", &[], &["latency-map-gain", "latency-map-step"]),
    tried("C63", "latency", &[], &["9.14", "9.15"]),
    tried("C64", "jitter", &[VelocityVerlet], &["9.12"]),
    // Equality to the bit.
    tried("C65", "jitter", &[], &[]),
    tried("C65a", "asynchrony", &[VelocityVerlet], &["dephasing", "asynchrony-alone"]),
    // Of bits, which are counted in a table.
    tried("C66", "determinism", &[], &[]),
    tried("C67", "hierarchy", &[], &["9.16", "9.17"]),
    tried("C67a", "precision", &[SymplecticEuler, VelocityVerlet, Rk4], &["precision-types"]),
    tried("C68", "throughput", &[], &["9.7"]),
    tried("C69", "throughput", &[], &[]),
    tried("C70", "stability", FOUR, &["9.5"]),
    tried("C71", "asynchrony", &[VelocityVerlet], &[]),
    of_its_run("C73", "drift", &[SymplecticEuler, VelocityVerlet, Rk4], &["9.1"]),
    of_its_run("C74", "error", &[ExplicitEuler], &["9.3"]),
    of_its_run("C75", "error", &[SymplecticEuler], &["9.3"]),
    of_its_run("C76", "error", &[VelocityVerlet], &["9.3"]),
    of_its_run("C77", "error", &[Rk4], &["9.3"]),
    of_its_run("C78", "error", EULERS_VERLET, &["9.3"]),
    of_its_run("C79", "error", FOUR, &["9.3", "error-step"]),
    tried("C80", "stability", FOUR, &["9.5"]),
    tried("C81", "efficiency", FOUR, &["9.6"]),
    tried("C82", "throughput", &[], &["9.7"]),
    tried("C84", "rollout", &[], &["9.11"]),
    tried("C85", "rollout", &[], &["9.11"]),
    tried("C86", "rollout", &[], &["9.11"]),
    tried("C87", "rollout", &[], &["9.11"]),
    tried("C88", "rollout", &[], &["9.11"]),
    tried("C89", "rollout", &[], &["step-times"]),
    tried("C90", "memory", &[], &["9.10"]),
    tried("C91", "rollout", &[], &["9.9", "step-times"]),
    tried("C93", "jitter", &[SymplecticEuler, VelocityVerlet], &["9.13", "9.12"]),
    tried("C95", "rollout", &[], &["9.11"]),
    tried("C96", "rollout", &[], &["9.9"]),
];

/// The claims that the study `name` tries.
pub fn by(name: &str) -> Vec<&'static Tried> {
    TRIED.iter().filter(|claim| claim.study == name).collect()
}

/// The claims that `records`, left by `studies`, do not judge, and why.
pub fn unjudged(config: &Config, studies: &[&dyn Study], records: &[Record]) -> Vec<Unjudged> {
    let in_hand: Vec<&Tried> = studies.iter().flat_map(|study| study.tries()).collect();
    let judged = |claim: &&Tried| records.iter().flat_map(|r| &r.claims).any(|c| c.id == claim.id);
    TRIED
        .iter()
        .filter(|claim| !judged(claim))
        .map(|claim| {
            let missing = (!in_hand.contains(&claim)).then_some(claim.study);
            let because = match missing {
                None => claim.why_not(config),
                Some(study) if records.iter().any(|r| r.name == study) => {
                    format!("its study, `{study}`, was run on other systems")
                }
                Some(study) => format!("its study, `{study}`, was not run"),
            };
            Unjudged { id: claim.id, because, missing }
        })
        .collect()
}

impl Tried {
    /// Why no run under this configuration judged it.
    fn why_not(&self, config: &Config) -> String {
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

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::untried::UNTRIED;

    #[test]
    fn every_claim_is_accounted_for_once() {
        let mut wanted: BTreeSet<String> =
            (1..=91).chain([93, 95, 96]).map(|number| format!("C{number:02}")).collect();
        wanted.extend("C53a C58a C59a C59b C59c C65a C67a".split(' ').map(String::from));
        let ids = TRIED.iter().map(|c| c.id).chain(UNTRIED.iter().map(|c| c.id));
        let found: Vec<String> = ids.map(String::from).collect();
        assert_eq!(found.len(), wanted.len());
        assert_eq!(found.into_iter().collect::<BTreeSet<_>>(), wanted);
    }
}
