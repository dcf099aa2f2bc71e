//! Which integrator a step is, by its results.

use libration::analysis::StabilityFunction;
use libration::integrator::ImplicitIntegrator;
use libration::{AnyMethod, Method};
use serde::Serialize;

use crate::BlackBoxError;
use crate::convergence::displaced;
use crate::prober::Prober;
use crate::rates::NumericalSystem;
use crate::unknown_error::is_unknown_error;

/// States up to which all implicit methods are compared, also after one agrees.
const MOST_STATES_OF_ALL: usize = 12;
/// Part of the scales by which the state is displaced.
const DISPLACEMENT: f64 = 0.25;
/// Errors of rates that a candidate may be off, since each step uses several.
const ERRORS: f64 = 20.0;
/// Roundings in units of the scales.
const ROUNDING: f64 = 1e-13;
/// An allowed distance must be so far below that of the farthest candidate, or the steps are too short to tell integrators apart.
const CLEAR: f64 = 1e-3;

/// The integrators that have the results of a step.
#[derive(Clone, Debug, Serialize)]
pub struct Recognition {
    /// By a step from a displaced state.
    pub by_results: Match,
    /// By the matrix of the step; none without positions and velocities, or off an equilibrium.
    pub by_matrix: Option<Match>,
}

/// A comparison of a step with that of each integrator.
#[derive(Clone, Debug, Serialize)]
pub struct Match {
    /// Names of the integrators that agree; several agree if they do the same on this system.
    pub methods: Vec<&'static str>,
    /// Whether the candidates are far enough apart to tell them from each other.
    pub is_clear: bool,
    /// All candidates, the nearest first.
    pub candidates: Vec<Candidate>,
    /// The largest distance that errors of the rates explain, in units of the scales.
    pub allowed: f64,
}

/// An integrator, on the rates of the system that were measured.
#[derive(Clone, Debug, Serialize)]
pub struct Candidate {
    /// Its name on the command line.
    pub method: &'static str,
    /// Its name in running text.
    pub title: String,
    /// The largest distance of its step from that of the simulator, in units of the scales.
    pub distance: f64,
}

impl Match {
    /// Whether an integrator agrees, in a word; unknown if errors of unknown size may explain its distance.
    pub fn agreement(&self, method: &str) -> &'static str {
        match self.methods.contains(&method) {
            true => "yes",
            false if is_unknown_error(self.allowed) => "unknown",
            false => "no",
        }
    }

    /// Compares the step from a displaced state with that of each integrator, on rates from short steps of the simulator itself. Implicit
    /// ones of a higher order than the step has are left out.
    pub(crate) fn by_results(
        prober: &mut Prober<'_>,
        pairs: Option<&[(usize, usize)]>,
        order: Option<u32>,
    ) -> Result<Self, BlackBoxError> {
        let subject = prober.subject;
        let (start, dt) = (displaced(prober, DISPLACEMENT), subject.dt);
        let next = prober.step_one(&start, &subject.action, dt)?;
        let is_mechanical = pairs.is_some_and(|pairs| pairs.len() * 2 == start.len());
        let pairs = pairs.filter(|_| is_mechanical).map(<[_]>::to_vec);
        let system = NumericalSystem::new(prober, pairs);
        let applies =
            |method: &AnyMethod| is_mechanical || StabilityFunction::of(*method).is_some();
        let mut candidates: Vec<Candidate> = Vec::new();
        let mut error = 0.0_f64;
        for method in AnyMethod::all().filter(applies) {
            // Implicit methods take many more steps, and do the same as explicit ones where nothing is damped.
            let is_found = |found: &Candidate| found.distance <= ERRORS * error * dt + ROUNDING;
            let is_large = start.len() > MOST_STATES_OF_ALL && candidates.iter().any(is_found);
            let is_explicit = |found: &Candidate| Method::from_name(found.method).is_some();
            let by_explicit = candidates.iter().any(|found| is_found(found) && is_explicit(found));
            let is_implicit = matches!(method, AnyMethod::Implicit(_));
            if is_implicit && (by_explicit || is_large) {
                break;
            }
            // On a system a method may have a higher order than its own, but no lower one.
            if is_implicit && order.is_some_and(|order| method.order() > order) {
                continue;
            }
            let state = method.step(&system, system.point(&start), dt);
            error = error.max(system.take_error()?);
            let found = system.values(&state, start.len());
            let apart = |i: usize| ((found[i] - next[i]) / subject.state_scale[i]).abs();
            let distance = (0..start.len()).map(apart).fold(0.0, f64::max);
            if distance.is_finite() {
                candidates.push(Candidate {
                    method: method.name(),
                    title: method.title().to_owned(),
                    distance,
                });
            }
        }
        let allowed = ERRORS * error * dt + ROUNDING;
        let moved = (0..start.len()).map(|i| ((next[i] - start[i]) / subject.state_scale[i]).abs());
        let change = moved.fold(0.0, f64::max);
        Ok(Match::new(candidates, allowed, change, order))
    }

    /// `change` is that of the step itself, in units of the scales: errors of its size say nothing, even if a candidate diverges.
    /// `order` is that of the step, if it is known.
    pub(crate) fn new(
        mut candidates: Vec<Candidate>,
        allowed: f64,
        change: f64,
        order: Option<u32>,
    ) -> Self {
        candidates.sort_by(|a, b| a.distance.total_cmp(&b.distance));
        let farthest = candidates.last().map_or(0.0, |last| last.distance.min(change));
        let is_clear = allowed < CLEAR * farthest;
        // Where forces are simple, methods of a higher order have the same results.
        let has_order = |found: &Candidate| {
            let own = AnyMethod::from_name(found.method).map(AnyMethod::order);
            order.is_none() || own <= order
        };
        let methods = candidates
            .iter()
            .filter(|found| is_clear && found.distance <= allowed && has_order(found))
            .map(|found| found.method)
            .collect();
        Match { methods, is_clear, candidates, allowed }
    }

    /// Titles of the integrators that agree.
    pub(crate) fn titles(&self) -> Vec<&str> {
        let agrees = |candidate: &&Candidate| self.methods.contains(&candidate.method);
        self.candidates.iter().filter(agrees).map(|candidate| candidate.title.as_str()).collect()
    }
}
