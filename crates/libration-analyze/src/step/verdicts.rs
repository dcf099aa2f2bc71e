//! Verdicts on a step of a system of the catalogue.

use std::sync::atomic::AtomicBool;

use libration::AnySystem;
use libration::ensemble::dynamics_of;
use libration::equations::StepProgram;
use libration::linear::GROWTH_ROUNDING;
use libration_report::verdict::{FOLLOWED, Outcome, Verdict};
use libration_settings::units;
use serde::Serialize;

use super::limits::is_free;
use super::{Analysis, AnalyzeError, LoopAnalysis, Request};
use crate::digits::change_per_step;
use crate::motion::{MotionExamination, MotionState, MotionSubject, examine};
use crate::step_verdict::StepGrowth;

/// The verdicts on a step of a system of the catalogue. Of a loop there is that of the loop alone.
#[derive(Clone, Debug, Default, Serialize)]
pub struct StepVerdicts {
    /// Whether the loop is stable; none without a loop.
    #[serde(rename = "loop", skip_serializing_if = "Option::is_none")]
    pub closed_loop: Option<Verdict>,
    /// Whether the step lets deviations grow more than exact steps do; of nonlinear systems only at an equilibrium at which they rest.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub step: Option<Verdict>,
    /// Whether the steps resolve the motion of a nonlinear system.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub motion: Option<Verdict>,
}

impl StepVerdicts {
    pub(super) fn new(analysis: &Analysis, request: &Request) -> Self {
        let closed_loop = analysis.timing.as_ref().and_then(of_loop);
        let is_loop = closed_loop.is_some();
        StepVerdicts {
            closed_loop,
            step: match &analysis.motion {
                _ if is_loop => None,
                _ if request.system.is_linear() => Some(of_step(analysis, request)),
                // A motion at rest is followed, whatever becomes of deviations that grow.
                Some(motion) if motion.is_at_rest() => {
                    Some(at_rest(analysis)).filter(|own| own.outcome != Outcome::NotResolved)
                }
                _ => None,
            },
            motion: analysis.motion.as_ref().map(|motion| motion.verdict.clone()),
        }
    }

    /// All that there are.
    pub fn all(&self) -> impl Iterator<Item = &Verdict> {
        self.closed_loop.iter().chain(&self.step).chain(&self.motion)
    }
}

/// The step at an equilibrium of a nonlinear system, by the rule of systems by equations.
fn at_rest(analysis: &Analysis) -> Verdict {
    let dt = analysis.request.dt;
    let growth = StepGrowth {
        dt,
        radius: Some(1.0 + analysis.spectral_radius_minus_one),
        exact_rate: analysis.flow_spectral_radius_minus_one.ln_1p() / dt,
        has_parted: false,
        stable_dt: None,
        has_stability_function: false,
        modes: Vec::new(),
    };
    growth.verdict()
}

fn of_step(analysis: &Analysis, request: &Request) -> Verdict {
    let excess = analysis.spectral_radius_minus_one;
    let exact = analysis.flow_spectral_radius_minus_one;
    // What rounded parameters change in the growth of exact steps.
    let rounding = 0.5 * f64::EPSILON * exact.abs();
    let motions = format!("motions {}", change_per_step(excess));
    let moments = analysis.timing.as_ref().and_then(|timing| timing.growth?.mean_square_growth);
    if let Some(growth) = moments.filter(|growth| *growth > GROWTH_ROUNDING) {
        let moments = change_per_step(growth);
        return Verdict::new(
            Outcome::Unstable,
            format!("second moments {moments} under the stated time steps"),
        );
    }
    if excess != 0.0 && excess.abs() <= rounding {
        return Verdict::unknown(
            "at the limit of stability, motions neither grow nor decay beyond the rounding of its parameters",
        );
    }
    let turn = match request.system {
        AnySystem::Oscillator(model) => model.omega2 * request.dt * request.dt,
        _ => 0.0,
    };
    if excess > 0.0 && excess <= COEFFICIENTS * turn {
        return Verdict::unknown(
            "motions grow by less than the rounding of the coefficients of the integrator",
        );
    }
    if exact > GROWTH_ROUNDING && FOLLOWED * excess.ln_1p() < exact.ln_1p() {
        return Verdict::new(
            Outcome::NotResolved,
            format!("{motions}, and those of exact steps {}", change_per_step(exact)),
        );
    }
    match analysis.bounded {
        Some(true) if excess < 0.0 => Verdict::new(Outcome::Stable, motions),
        Some(true) => Verdict::new(Outcome::Stable, "every motion stays bounded"),
        Some(false) if excess == 0.0 && is_free(request.system) => Verdict::new(
            Outcome::Stable,
            "motions grow in proportion to time, as those of exact steps do",
        ),
        Some(false) if excess == 0.0 => {
            Verdict::new(Outcome::Unstable, "motions grow without bound, but not exponentially")
        }
        Some(false) if exact > 0.0 => {
            let outcome =
                if excess <= FASTER * exact { Outcome::Stable } else { Outcome::Unstable };
            let evidence =
                format!("{motions}, and those of exact steps {}", change_per_step(exact));
            Verdict::new(outcome, evidence)
        }
        Some(false) => Verdict::new(Outcome::Unstable, motions),
        None => Verdict::unknown("its coupled modes neither grow nor decay"),
    }
}

/// Growth per step, for each squared radian of it, that roundings of a dozen coefficients of an integrator may cause.
const COEFFICIENTS: f64 = 8.0 * f64::EPSILON;

/// A motion that grows in exact steps may grow by this part faster: the step is inaccurate then, not unstable.
const FASTER: f64 = 1.5;

/// None without feedback.
fn of_loop(analysis: &LoopAnalysis) -> Option<Verdict> {
    let excess = analysis.closed_loop_spectral_radius_minus_one?;
    let moments = analysis.growth.and_then(|growth| growth.mean_square_growth);
    let motions = format!("its motions {}", change_per_step(excess));
    let squares =
        moments.map(|growth| format!(", and their second moments {}", change_per_step(growth)));
    let worst = moments.map_or(excess, |growth| excess.max(growth));
    let is_known = analysis.growth.is_none() || moments.is_some();
    let evidence = motions + &squares.unwrap_or_default();
    Some(match (worst > 0.0, worst < 0.0) {
        (true, _) => Verdict::new(Outcome::Unstable, evidence),
        _ if !is_known => Verdict::unknown(format!(
            "stable without jitter and losses, and with them it is not known: {evidence}"
        )),
        (_, true) => Verdict::new(Outcome::Stable, evidence),
        _ => Verdict::unknown(format!("at the limit of stability: {evidence}")),
    })
}

/// The motion of a nonlinear system; none of linear ones, and with a loop.
///
/// # Errors
/// [`AnalyzeError::Interrupted`].
pub(super) fn motion(
    request: &Request,
    stop: &AtomicBool,
) -> Result<Option<MotionExamination>, AnalyzeError> {
    let dimension = request.q.len();
    let (Some(method), false) = (request.stepping.any_method(), request.system.is_linear()) else {
        return Ok(None);
    };
    let dynamics = dynamics_of(request.system, dimension);
    let Some(dynamics) = dynamics.filter(|_| request.timing.first().is_none()) else {
        return Ok(None);
    };
    let step = StepProgram::of(method, &dynamics);
    let units = units::of(request.system, request.actuation);
    // Its second coordinate is time.
    let is_driven = matches!(request.system, AnySystem::DrivenOscillator(_));
    let state = |place: usize| {
        let (i, is_velocity) = (place % dimension, place >= dimension);
        let (letter, unit) =
            if is_velocity { ("v", units.velocity) } else { ("q", units.position) };
        let unit = if unit == "1" { "" } else { unit };
        MotionState { place, name: format!("{letter}{i}"), unit: unit.to_owned(), is_velocity }
    };
    let places = (0..2 * dimension).filter(|place| !(is_driven && place % dimension == 1));
    let states: Vec<MotionState> = places.map(state).collect();
    let mut start: Vec<f64> = request.q.iter().chain(&request.v).copied().collect();
    start.resize(2 * dimension + dynamics.inputs(), 0.0);
    let subject = MotionSubject {
        dynamics: &dynamics,
        start: &start,
        states: &states,
        is_affine: false,
        energy_unit: units.energy,
    };
    Ok(Some(examine(&subject, &step, request.dt, request.steps, stop)?))
}
