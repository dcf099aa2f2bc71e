//! Work and precision of all explicit integrators on a motion: the output of `libration analyze --compare`.

mod dense_reference;
mod error;
mod motion;
mod prediction;
mod search;

use std::sync::atomic::AtomicBool;

use libration::Method;
use libration_report::notation::cut_off;
use libration_report::verdict::{Outcome, Verdict};
use libration_settings::equations::EquationSystem;
use libration_work::Work;
use serde::Serialize;

pub use error::{ComparisonError, TOLERANCES};
use motion::Motion;
use prediction::Yardsticks;
use search::Search;

use crate::motion::narrow_force;
pub use search::{MOST_EVALUATIONS, MOST_OF_BEST};

/// Version of the JSON format.
pub const SCHEMA: &str = "libration.integrator-comparison/1";

/// A motion, and the error that is allowed.
#[derive(Clone, Debug)]
pub struct ComparisonRequest {
    /// The system with its start; its inputs are zero.
    pub system: EquationSystem,
    /// The time of the motion in s.
    pub horizon: f64,
    /// The largest error of a state after any step (of more than 4096, after as many and where the motion is fast), relative to the largest size of that state in the motion.
    pub tolerance: f64,
}

/// All explicit integrators on a motion; the fields are the keys of `analyze --compare --json`.
#[derive(Clone, Debug, Serialize)]
pub struct Comparison {
    /// The version of this format.
    pub schema: &'static str,
    /// The name of the system.
    pub system: String,
    /// The time of the motion in s.
    pub horizon: f64,
    /// The allowed error.
    pub tolerance: f64,
    /// What the reference may be wrong by, in the measure of the tolerance.
    pub reference_error: f64,
    /// Whether forces depend on positions alone. Otherwise splitting methods lose their order, and those by tables are left out.
    pub is_positional: bool,
    /// Whether forces have no kinks and jumps. Otherwise what acts for less than the horizon over 2048 may be missed.
    pub is_smooth: bool,
    /// The integrators, the cheapest first; those that do not meet the tolerance come last.
    pub integrators: Vec<ComparedIntegrator>,
    /// Whether an integrator meets the tolerance, with what was not tried.
    pub verdict: Verdict,
    /// The most force evaluations of the motion that an integrator was tried with.
    pub most_evaluations: f64,
}

/// An integrator on a motion.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ComparedIntegrator {
    /// The name.
    pub integrator: &'static str,
    /// The classical order; for forces of velocities, the order on this system.
    pub order: u32,
    /// Force evaluations of a step; for forces of positions, neighbouring steps share those at their ends.
    pub stages: usize,
    /// The norm of the leading error for forces of positions, over the power of the step; none for forces of velocities.
    pub error_constant: Option<f64>,
    /// The largest step found that meets the tolerance, as half of it does, in s: the horizon over a whole number. None if none does.
    pub dt: Option<f64>,
    /// Force evaluations for the whole motion with this step.
    pub evaluations: Option<f64>,
    /// The same, predicted from the error constant and the evaluations of the integrator of the same order with the fewest stages; none
    /// for that integrator.
    pub predicted_evaluations: Option<f64>,
    /// The error with this step; without one, the smallest error found.
    pub error: Option<f64>,
    /// The largest error of the energy with this step, relative to the mean kinetic energy of the motion; none without an energy.
    ///
    /// The same scale as that of `advise --tolerance energy=`.
    pub energy_error: Option<f64>,
}

/// Whether an integrator meets the tolerance.
fn judge(integrators: &[ComparedIntegrator], tolerance: f64, most: f64) -> Verdict {
    let verdict = match integrators.first().and_then(|one| Some((one, one.dt?, one.error?))) {
        Some((best, dt, error)) => Verdict::new(
            Outcome::Within,
            format!(
                "{} in steps of {} s: an error of {error:.3e} of at most {tolerance:e}",
                best.integrator,
                cut_off(dt, 4)
            ),
        ),
        None => Verdict::unknown(format!(
            "no integrator keeps {tolerance:e} with at most {most:.0} force evaluations, and more were not tried"
        )),
    };
    verdict.without("implicit integrators").without("steps of variable length")
}

/// The verdict where a force acts between the evaluations of a reference.
pub fn missed_force(time: f64) -> Verdict {
    Verdict::unknown(format!(
        "a force acts before {time:.4e} s for less time than the evaluations of the reference are apart, so errors are not known"
    ))
}

/// Compares all explicit integrators on a motion.
///
/// # Errors
/// [`ComparisonError`]: an invalid request, a motion that ends, a reference that is not known to the tolerance, or an interrupt.
pub fn compare(
    work: &Work<'_>,
    request: &ComparisonRequest,
) -> Result<Comparison, ComparisonError> {
    error::check(request)?;
    let dynamics = request.system.equations.dynamics();
    let is_positional = dynamics.is_positional();
    let motion = work.part("reference", || Motion::new(work, request))?;
    let is_compared = |method: &Method| is_positional || !method.supposes_positional_forces();
    let methods: Vec<Method> = Method::all().filter(is_compared).collect();
    let search = Search::new(work, &motion, is_positional)?;
    let mut integrators = work.sweep("integrators", &methods, |&method| search.of(work, method))?;
    Yardsticks::new(&integrators).predict(&mut integrators);
    let cost = |one: &ComparedIntegrator| one.evaluations.unwrap_or(f64::INFINITY);
    integrators.sort_by(|a, b| cost(a).total_cmp(&cost(b)).then(a.order.cmp(&b.order)));
    let verdict = judge(&integrators, request.tolerance, search.most_evaluations());
    let never = AtomicBool::new(false);
    let missed = narrow_force(dynamics, &request.system.initial_state(), request.horizon, &never);
    let verdict = match missed.ok().flatten() {
        Some(time) if verdict.is_good() => missed_force(time),
        _ => verdict,
    };
    Ok(Comparison {
        verdict,
        most_evaluations: search.most_evaluations(),
        schema: SCHEMA,
        system: request.system.name.clone(),
        horizon: request.horizon,
        tolerance: request.tolerance,
        reference_error: motion.reference_error(),
        is_positional,
        is_smooth: dynamics.accelerations().is_smooth(),
        integrators,
    })
}
